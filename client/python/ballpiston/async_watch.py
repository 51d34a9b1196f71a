"""Following a job in an event loop: the watch waits without a thread.

It is the watch of watch.py over gRPC's asyncio channel. Only what takes a moment runs in a thread:
a private server that has stopped is started again.
"""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Any

import grpc
import grpc.aio

from ballpiston.channel import open_channel
from ballpiston.connection import Connection
from ballpiston.point import Point
from ballpiston.progress import fraction_of, progress_in
from ballpiston.spelling import spelled
from ballpiston.v1 import ensemble_pb2_grpc
from ballpiston.watch import Attachments, connect_again, ended_early


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
        ResourceExhausted: the server was busy for two minutes.
        Error: any other error of the server.
    """
    watch = Attachments(name)
    state = "queued"
    while True:
        why = ended_early()
        async with open_channel(connection.address, connection.security, grpc.aio) as channel:
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
            yield watch.ended
            return
        await asyncio.sleep(watch.pause_after(why))
        await asyncio.to_thread(connect_again, connection)
