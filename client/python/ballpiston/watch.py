"""Following a job to its end, through restarts of the server and cut connections.

If the stream breaks, the watch attaches again with the last resume token that it saw, after pauses
that double from 0.1 s to 5 s, or as long as the server's error says, until nothing was heard for two minutes. A stream is broken by
UNAVAILABLE, by CANCELLED without a reason, as from a server that stops, and by an end without a
terminal state. Every other error ends the watch.
"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass
from typing import Any, Protocol

import grpc

from ballpiston.connection import Connection
from ballpiston.errors import Error, Unavailable
from ballpiston.v1 import ensemble_pb2

_LONGEST_CONNECTING = 1.0  # seconds

_ENDED = (
    ensemble_pb2.EnsembleJob.SUCCEEDED,
    ensemble_pb2.EnsembleJob.FAILED,
    ensemble_pb2.EnsembleJob.CANCELLED,
)


def has_ended(state: int) -> bool:
    """SUCCEEDED, FAILED or CANCELLED."""
    return state in _ENDED


class Observer(Protocol):
    """What a watch calls, on the thread that watches."""

    def on_job(self, job: Any) -> None:
        """At first, and at each change of state."""

    def on_snapshot(self, snapshot: Any) -> None:
        """Progress, and points that changed."""

    def on_disconnect(self, why: Error, pause: float) -> None:
        """The stream broke; the next attempt follows after `pause` seconds."""


@dataclass(frozen=True)
class Pauses:
    """Seconds: the first pause, the longest one, and when a watch gives up."""

    first: float = 0.1
    longest: float = 5.0
    give_up_after: float = 120.0


class ReattachPace:
    """When a watch that lost its server attaches again, and when it gives up. Each pause is up to a
    quarter longer than needed, so that the watchers of a server that died do not return as one. The
    times are the caller's, so that this can be tested without waiting."""

    def __init__(self, pauses: Pauses, now: float) -> None:
        self._pauses = pauses
        self._heard = now
        self._next = pauses.first

    def heard(self, now: float) -> None:
        """The server said something: the pauses and the time to give up start again."""
        self._heard = now
        self._next = self._pauses.first

    def next_pause(self, now: float, least: float = 0.0) -> float | None:
        """Seconds before the next attempt, at least `least`; None if that would come after the time
        to give up."""
        pause = max(self._next, least) * random.uniform(1.0, 1.25)
        self._next = min(2 * self._next, self._pauses.longest)
        return None if now - self._heard + pause > self._pauses.give_up_after else pause


def watch_job(
    connection: Connection, name: str, observer: Observer, pauses: Pauses = Pauses()
) -> Any:
    """Blocks until the job has ended and returns it, as an EnsembleJob.

    Raises:
        Unavailable: the watch gave up.
        Error: any other error of the server.
    """
    return _Watch(connection, name, observer, pauses).follow()


class _Watch:
    def __init__(
        self, connection: Connection, name: str, observer: Observer, pauses: Pauses
    ) -> None:
        self._connection = connection
        self._observer = observer
        self._pauses = pauses
        self._pace = ReattachPace(pauses, time.monotonic())
        self._request = ensemble_pb2.WatchEnsembleJobRequest(name=name)
        self._ended: Any = None

    def follow(self) -> Any:
        while True:
            why = self._read_stream()
            if self._ended is not None:
                return self._ended
            if not _is_broken_stream(why):
                raise why
            self._wait_to_reattach(why)

    def _read_stream(self) -> Error:
        """One attachment, to its end, and why it ended."""
        stream = self._connection.open_stream(
            self._connection.ensembles.WatchEnsembleJob, self._request
        )
        try:
            for message in stream:
                self._handle(message)
        except grpc.RpcError as error:
            return self._connection.error_of(error)
        finally:
            stream.cancel()
        return Unavailable(
            "the server ended the watch before the end of the job", code="UNAVAILABLE"
        )

    def _handle(self, message: Any) -> None:
        self._pace.heard(time.monotonic())
        if message.resume_token:
            self._request.resume_token = message.resume_token
        if message.HasField("job"):
            if has_ended(message.job.state):
                self._ended = message.job
            self._observer.on_job(message.job)
        elif message.HasField("snapshot"):
            self._observer.on_snapshot(message.snapshot)

    def _wait_to_reattach(self, why: Error) -> None:
        pause = self._pace.next_pause(time.monotonic(), why.retry_delay)
        if pause is None:
            silence = f"{self._pauses.give_up_after:g} s"
            raise Unavailable(
                f"gave up watching after {silence} without the server: {why}", code="UNAVAILABLE"
            ) from why
        self._observer.on_disconnect(why, pause)
        time.sleep(pause)
        try:
            self._connection.revive(_LONGEST_CONNECTING)
        except Unavailable:
            pass  # the next attempt reports what goes wrong


def _is_broken_stream(why: Error) -> bool:
    return why.code == "UNAVAILABLE" or (why.code == "CANCELLED" and not why.reason)
