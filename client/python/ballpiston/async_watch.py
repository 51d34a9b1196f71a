"""Following a job in an event loop: the watch waits without a thread.

It is the watch of watch.py over gRPC's asyncio channel. Only what takes a moment runs in a thread:
a private server that has stopped is started again.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Any

import grpc

from ballpiston.channel import open_async_channel
from ballpiston.connection import Connection
from ballpiston.errors import Error, Unavailable
from ballpiston.point import Point
from ballpiston.progress import fraction_of
from ballpiston.spelling import spelling
from ballpiston.v1 import ensemble_pb2, ensemble_pb2_grpc
from ballpiston.watch import LONGEST_CONNECTING, Attachments, ended_early


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


async def watch_updates(connection: Connection, name: str) -> AsyncIterator[Update | Any]:
    """Updates until the job has ended, and last the job itself, as an EnsembleJob.

    Raises:
        Unavailable: the server did not answer for two minutes.
        Error: any other error of the server.
    """
    updates = _Updates()
    watch = Attachments(name, updates)
    while True:
        why = ended_early()
        async with open_async_channel(connection.address, connection.security) as channel:
            stub = ensemble_pb2_grpc.EnsembleServiceStub(channel)
            try:
                async for message in stub.WatchEnsembleJob(
                    watch.request, metadata=connection.metadata()
                ):
                    watch.handle(message)
                    for update in updates.take():
                        yield update
            except grpc.RpcError as error:
                why = connection.error_of(error)
        if watch.ended is not None:
            yield watch.ended
            return
        await asyncio.sleep(watch.pause_after(why))
        await _revive(connection)


async def _revive(connection: Connection) -> None:
    try:
        await asyncio.to_thread(connection.revive, LONGEST_CONNECTING)
    except Unavailable:
        pass  # the next attempt reports what goes wrong


class _Updates:
    """The observer that turns messages into updates."""

    def __init__(self) -> None:
        self._state = "queued"
        self._new: list[Update] = []

    def take(self) -> list[Update]:
        taken, self._new = self._new, []
        return taken

    def on_job(self, job: Any) -> None:
        self._state = spelling(ensemble_pb2.EnsembleJob.State, job.state)
        self._new.append(Update(self._state, fraction_of(job.progress), []))

    def on_snapshot(self, snapshot: Any) -> None:
        points = [Point(m) for m in (*snapshot.points, *snapshot.finished_points)]
        self._new.append(Update(self._state, fraction_of(snapshot.progress), points))

    def on_disconnect(self, why: Error, pause: float) -> None:
        pass
