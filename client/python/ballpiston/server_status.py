"""What a server is doing, and what it permits."""

from dataclasses import dataclass, field
from typing import Any

from ballpiston.fields import record_of, spelled


@dataclass(frozen=True)
class ServerStatus:
    """The state of a server.

    Attributes:
        address: of the server, as the client was given it.
        state: "serving", "draining" (no new jobs) or "store-failing" (the disk refuses writes).
        version, engine_version: of the program, and of the part that decides the numbers.
        workers, busy_workers: threads that compute.
        queued_jobs, running_jobs: of all users.
        principal, role: who you are to this server; the role is read, submit or admin.
        limits: of the server by name, 0 for none, such as limits["max_points_per_job"].
        message: everything, as the message ballpiston.v1.ServerStatus.
    """

    address: str
    state: str
    version: str
    engine_version: str
    workers: int
    busy_workers: int
    queued_jobs: int
    running_jobs: int
    principal: str
    role: str
    limits: dict[str, float]
    message: Any = field(repr=False)


def server_status_of(address: str, message: Any) -> ServerStatus:
    """Of a message ballpiston.v1.ServerStatus."""
    same = ("version", "engine_version", "workers", "busy_workers", "queued_jobs", "running_jobs")
    return ServerStatus(
        address=address,
        state=spelled(message, "state"),
        limits=record_of(message.limits),
        message=message,
        **{name: getattr(message, name) for name in (*same, "principal", "role")},
    )
