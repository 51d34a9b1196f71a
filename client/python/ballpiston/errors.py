"""Exceptions. Every one that a server or the connection causes is a subclass of Error.

Mistakes in a call itself, such as a wrong keyword or a text in place of a number, are TypeError and
ValueError. They are raised before anything is sent.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from ballpiston._google_rpc import error_details_pb2, status_pb2


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


def facts_of(status: Any) -> dict[str, Any]:
    """What a google.rpc.Status says beside its message, as keywords of an Error. Details of other
    types are ignored."""
    facts: dict[str, Any] = {}
    for item in status.details:
        info, bad = error_details_pb2.ErrorInfo(), error_details_pb2.BadRequest()
        retry = error_details_pb2.RetryInfo()
        if item.Unpack(info) and "reason" not in facts:
            facts |= {"reason": info.reason, "metadata": dict(info.metadata)}
        if item.Unpack(bad):
            violations = [(v.field, v.description) for v in bad.field_violations]
            facts["violations"] = facts.get("violations", []) + violations
        if item.Unpack(retry):
            facts["retry_delay"] = retry.retry_delay.seconds + 1e-9 * retry.retry_delay.nanos
    return facts


def text_of(message: str, facts: Mapping[str, Any]) -> str:
    """The text of an error with these facts, as the program `ballpiston` prints it: MESSAGE
    (REASON), or FIELD: DESCRIPTION (REASON), or a line for each violation."""
    reason = f" ({facts['reason']})" if facts.get("reason") else ""
    stated = facts.get("metadata", {}).get("violations_left_out", "")
    left_out = int(stated) if stated.isdecimal() else 0
    lines = [f"{where}: {what}" for where, what in facts.get("violations", [])]
    count = len(lines) + left_out
    if count == 0:
        return message + reason
    if count == 1 and left_out == 0:
        return lines[0] + reason
    more = f"\n  and {left_out} more" if left_out > 0 else ""
    return f"not valid, {count} violations{reason}:" + "".join(f"\n  {x}" for x in lines) + more


def from_rpc_error(rpc_error: Any) -> Error:
    """The exception for a grpc.RpcError."""
    code: str = rpc_error.code().name
    # dict(grpc.aio.Metadata) fails, because its keys() gives pairs; iter() gives the same pairs.
    metadata = dict(iter(rpc_error.trailing_metadata() or ()))
    details = metadata.get("grpc-status-details-bin", b"")
    try:
        facts = facts_of(status_pb2.Status.FromString(details))
    except Exception:  # its class depends on the implementation of protobuf
        facts = {}
    message = rpc_error.details() or ""
    message = message if any(facts.values()) else _plain_text(code, message)
    return _class_of(code, facts)(text_of(message, facts), code=code, **facts)


def _class_of(code: str, facts: Mapping[str, Any]) -> type[Error]:
    """The class NotFound is that of NOT_FOUND, and so on."""
    if code == "INVALID_ARGUMENT" and facts.get("violations"):
        return InvalidSpecification
    if code == "OUT_OF_RANGE":
        return InvalidArgument
    if facts.get("reason") == "RESULTS_EXPIRED":
        return ResultsExpired
    found: type[Error] = globals().get(code.title().replace("_", ""), Error)
    return found


def _plain_text(code: str, message: str) -> str:
    """gRPC says nothing at all about a method that the server lacks, and little about a message
    that is too large."""
    if code == "UNIMPLEMENTED" and not message:
        return "the server is of an earlier version, which does not offer this"
    sizes = re.search(r"message larger than max \((\d+) vs\. (\d+)\)", message)
    if code == "RESOURCE_EXHAUSTED" and sizes:
        return (
            f"the request or its answer is too large to be sent: {sizes[1]} bytes; "
            f"at most {sizes[2]} are permitted"
        )
    return message or code
