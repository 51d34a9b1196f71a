"""One orbit of the reference billiard, event by event."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import grpc

from ballpiston.connection import Connection
from ballpiston.record import record_of


def events_of(connection: Connection, request: Any) -> Iterator[dict[str, Any]]:
    """The start, then the events. If the private server stops before the start arrives, it is
    started again and asked once more; later a repetition would begin with the start again."""
    call = connection.open_stream(connection.traces.TraceOrbit, request)
    try:
        try:
            first = next(call)
        except grpc.RpcError as error:
            if connection.private is None or error.code() != grpc.StatusCode.UNAVAILABLE:
                raise
            connection.revive()
            call = connection.open_stream(connection.traces.TraceOrbit, request)
            first = next(call)
        yield record_of(first.start)
        yield from map(record_of, first.events)
        for message in call:
            yield from map(record_of, message.events)
    except grpc.RpcError as error:
        raise connection.error_of(error) from None
    finally:
        call.cancel()
