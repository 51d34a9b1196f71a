"""Exceptions. Every one that a server or the connection causes is a subclass of Error.

Mistakes in a call itself, such as a wrong keyword or a text in place of a number, are TypeError and
ValueError. They are raised before anything is sent.
"""

from collections.abc import Mapping, Sequence


class Error(Exception):
    """What a server answered in place of a result, or why no server answered.

    Attributes:
        reason: one word for programs, such as "JOB_NOT_FOUND"; empty if the server gave none, for
            instance because no server was reached.
        metadata: further facts by name, such as the limit that was reached.
        violations: pairs (field, description), one for each part of the request that is wrong.
        code: the name of the gRPC status code, such as "NOT_FOUND"; empty if there was no call.
        retry_delay: the least seconds to wait before a retry; 0 if the server did not say.
    """

    def __init__(
        self,
        message: str,
        *,
        reason: str = "",
        metadata: Mapping[str, str] | None = None,
        violations: Sequence[tuple[str, str]] = (),
        code: str = "",
        retry_delay: float = 0.0,
    ) -> None:
        super().__init__(message)
        self.reason = reason
        self.metadata = dict(metadata or {})
        self.violations = list(violations)
        self.code = code
        self.retry_delay = retry_delay


class InvalidArgument(Error, ValueError):
    """The server rejected the request."""


class InvalidSpecification(InvalidArgument):
    """The request has wrong values. `violations` lists all of them."""


class NotFound(Error):
    """No such job, or no result of that point."""


class Unauthenticated(Error):
    """No credentials, wrong ones, or credentials that have expired."""


class PermissionDenied(Error):
    """Authenticated but not authorised; or a secret file that other users can read."""


class FailedPrecondition(Error):
    """The state of the job does not permit the call, for instance it has already ended."""


class ResultsExpired(FailedPrecondition):
    """The server keeps only the specification: `client.submit(job.specification)` computes the same
    results again."""


class ResourceExhausted(Error):
    """A limit of the server was reached. `metadata` names it; the message says what helps."""


class DataLoss(Error):
    """The data in the server's store are damaged. A retry gives the same answer."""


class Unavailable(Error):
    """No server answers, or it is stopping: retry later."""


class DeadlineExceeded(Unavailable):
    """The server did not answer in time."""


class NoPrivateServer(Unavailable):
    """The private server cannot be started, for instance because no program is installed.
    `exit_code` is that of the program ballpiston, 0 if it was not run to its end."""

    exit_code = 0
