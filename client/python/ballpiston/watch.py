"""Following a job to its end, through restarts of the server and cut connections, in a thread that
waits or in an event loop.

If the stream breaks, the watch attaches again with the last resume token that it saw, after pauses
that double from 0.1 s to 5 s, or as long as the server's error says. The watch gives up if no
message arrives within two minutes of the moment at which the stream broke.

A stream is broken by UNAVAILABLE, by CANCELLED without a reason, as from a server that stops, by
RESOURCE_EXHAUSTED with a reason, as from a server that is busy, and by an end without a terminal
state. Every other error ends the watch.
"""

from __future__ import annotations

import asyncio
import random
import time
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import grpc
import grpc.aio

from ballpiston.connection import Connection
from ballpiston.errors import Error, Unavailable
from ballpiston.fields import spelled
from ballpiston.point import Point
from ballpiston.progress import Progress, fraction_of, progress_in
from ballpiston.v1 import ensemble_pb2, ensemble_pb2_grpc

_LONGEST_CONNECTING = 1.0  # seconds
_JOB = ensemble_pb2.EnsembleJob
# Why a stream ended that had no error and no ended job.
_EARLY_END: Error = Unavailable(
    "the server ended the watch before the end of the job", code="UNAVAILABLE"
)


def has_ended(state: int) -> bool:
    """SUCCEEDED, FAILED or CANCELLED."""
    return state in (_JOB.SUCCEEDED, _JOB.FAILED, _JOB.CANCELLED)


def watch_job(connection: Connection, watch: Attachments, screen: Progress) -> Any:
    """Blocks until the job has ended and returns it, as an EnsembleJob. Raises Unavailable,
    ResourceExhausted: the watch gave up; Error: any other error of the server."""
    while True:
        why = _EARLY_END
        try:
            for message in connection.stream(watch.request):
                watch.handle(message)
                screen.show(message)
        except Error as error:
            why = error
        if watch.ended is not None:
            return watch.ended
        pause = watch.pause_after(why)
        screen.show_pause(why.code == "RESOURCE_EXHAUSTED", pause)
        time.sleep(pause)
        _connect_again(connection)


def _connect_again(connection: Connection) -> None:
    """Waits up to a second for the connection. If there is none, the next stream reports the
    error."""
    with suppress(Unavailable):
        connection.revive(_LONGEST_CONNECTING)


class Attachments:
    """The streams of a watch: what the watch has received, when it reconnects, and when it gives
    up. All times are in seconds.

    Attributes:
        request: of the next stream; it has the last resume token.
        ended: the job, once it has ended.
    """

    def __init__(
        self, name: str, first: float = 0.1, longest: float = 5.0, give_up_after: float = 120.0
    ) -> None:
        self._first, self._longest, self._give_up_after = first, longest, give_up_after
        self.request = ensemble_pb2.WatchEnsembleJobRequest(name=name)
        self.ended: Any = None
        self._lost: float | None = None  # when the stream broke
        self._next = first  # pause

    def handle(self, message: Any) -> None:
        """A message of a stream: the pauses and the time to give up start again."""
        self._lost, self._next = None, self._first
        if message.resume_token:
            self.request.resume_token = message.resume_token
        if has_ended(message.job.state):
            self.ended = message.job

    def pause_after(self, why: Error) -> float:
        """Seconds until the next stream, after one that `why` ended. Raises Error: `why`, if it
        does not say that the stream broke, or if it is time to give up and the server is busy;
        Unavailable: it is time to give up, and no server answers."""
        broken = {("CANCELLED", False), ("RESOURCE_EXHAUSTED", True)}  # code, has a reason
        if why.code != "UNAVAILABLE" and (why.code, bool(why.reason)) not in broken:
            raise why
        pause = self.next_pause(time.monotonic(), why.retry_delay)
        if pause is None and why.code == "RESOURCE_EXHAUSTED":
            raise why
        if pause is None:
            silence = f"{self._give_up_after:g} s"
            raise Unavailable(
                f"gave up watching after {silence} without the server: {why}", code="UNAVAILABLE"
            ) from why
        return pause

    def next_pause(self, now: float, least: float = 0.0) -> float | None:
        """The pause, at least `least`; None if it would end after the time to give up. This time
        counts from the first call of next_pause after a message, not from the message: this process
        itself may have slept since then. Each pause is up to a quarter longer than needed, so that
        the watchers of a server that died do not reconnect at the same time."""
        self._lost = now if self._lost is None else self._lost
        pause = max(self._next, least) * random.uniform(1.0, 1.25)
        self._next = min(2 * self._next, self._longest)
        return None if now - self._lost + pause > self._give_up_after else pause


@dataclass(frozen=True)
class Update:
    """One message of a watch.

    Attributes:
        state: of the job, such as "running".
        progress: the share of the work that is done, 0 to 1.
        points: those that changed, finished or not.
    """

    state: str
    progress: float
    points: list[Point]


async def watch_updates(connection: Connection, watch: Attachments) -> AsyncIterator[Update]:
    """`watch_job` over gRPC's asyncio channel, without a thread: updates until the job ends."""
    state = "queued"
    while True:
        why = _EARLY_END
        async with connection.open_channel(grpc.aio) as channel:
            stub = ensemble_pb2_grpc.EnsembleServiceStub(channel)
            try:
                async for message in stub.WatchEnsembleJob(
                    watch.request, metadata=connection.metadata()
                ):
                    watch.handle(message)
                    if message.HasField("job"):
                        state = spelled(message.job, "state")
                    if (progress := progress_in(message)) is not None:
                        changed = (*message.snapshot.points, *message.snapshot.finished_points)
                        yield Update(state, fraction_of(progress), [Point(m) for m in changed])
            except grpc.RpcError as error:
                why = connection.error_of(error)
        if watch.ended is not None:
            return
        await asyncio.sleep(watch.pause_after(why))
        await asyncio.to_thread(_connect_again, connection)
