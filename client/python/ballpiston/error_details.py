"""Turns a failed call, or the error of a failed job, into an exception of errors.py.

The server attaches a google.rpc.Status with an ErrorInfo (the reason, as one word) and, if the
request is wrong, a BadRequest with every violation. The text is that of the program `ballpiston`.
"""

import re
from dataclasses import dataclass, field
from typing import Any, TypeVar

from ballpiston import errors
from ballpiston._google_rpc import error_details_pb2, status_pb2

_DETAILS_KEY = "grpc-status-details-bin"

AnyError = TypeVar("AnyError", bound=errors.Error)


@dataclass(frozen=True)
class Details:
    """The contents of the messages inside a google.rpc.Status, as the keywords of an Error."""

    reason: str = ""
    metadata: dict[str, str] = field(default_factory=dict)
    violations: list[tuple[str, str]] = field(default_factory=list)
    retry_delay: float = 0.0  # seconds

    def text(self, message: str) -> str:
        """MESSAGE (REASON), or FIELD: DESCRIPTION (REASON), or a line for each violation."""
        reason = f" ({self.reason})" if self.reason else ""
        stated = self.metadata.get("violations_left_out", "")
        left_out = int(stated) if stated.isdecimal() else 0
        count = len(self.violations) + left_out
        if count == 0:
            return message + reason
        lines = [f"{where}: {what}" for where, what in self.violations]
        if count == 1 and left_out == 0:
            return lines[0] + reason
        more = f"\n  and {left_out} more" if left_out > 0 else ""
        return f"not valid, {count} violations{reason}:" + "".join(f"\n  {x}" for x in lines) + more


def details_of(status: Any) -> Details:
    """Of a google.rpc.Status. Messages of other types are ignored."""
    reason, metadata, violations, retry_delay = "", {}, [], 0.0
    for item in status.details:
        info, bad = error_details_pb2.ErrorInfo(), error_details_pb2.BadRequest()
        retry = error_details_pb2.RetryInfo()
        if item.Unpack(info) and not reason:
            reason, metadata = info.reason, dict(info.metadata)
        if item.Unpack(bad):
            violations += [(v.field, v.description) for v in bad.field_violations]
        if item.Unpack(retry):
            retry_delay = retry.retry_delay.seconds + 1e-9 * retry.retry_delay.nanos
    return Details(reason, metadata, violations, retry_delay)


def error_of(error_class: type[AnyError], message: str, details: Details, code: str) -> AnyError:
    """An exception of that class with everything that the details say."""
    return error_class(details.text(message), code=code, **vars(details))


def from_rpc_error(rpc_error: Any) -> errors.Error:
    """The exception for a grpc.RpcError."""
    code: str = rpc_error.code().name
    details = _details_of_call(rpc_error)
    message = rpc_error.details() or ""
    if details == Details():
        message = _plain_text(code, message)
    return error_of(_class_of(code, details), message, details, code)


def _class_of(code: str, details: Details) -> type[errors.Error]:
    """The class NotFound is that of NOT_FOUND, and so on."""
    if code == "INVALID_ARGUMENT" and details.violations:
        return errors.InvalidSpecification
    if code == "OUT_OF_RANGE":
        return errors.InvalidArgument
    if details.reason == "RESULTS_EXPIRED":
        return errors.ResultsExpired
    found: type[errors.Error] = getattr(errors, code.title().replace("_", ""), errors.Error)
    return found


def _details_of_call(rpc_error: Any) -> Details:
    status = status_pb2.Status()
    try:
        status.ParseFromString(dict(rpc_error.trailing_metadata() or ()).get(_DETAILS_KEY, b""))
    except Exception:  # the class of the error depends on the implementation of protobuf
        return Details()
    return details_of(status)


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
