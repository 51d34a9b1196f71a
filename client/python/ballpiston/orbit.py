"""An orbit of the reference billiard, event by event."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston.connection import Connection
from ballpiston.fields import record_of
from ballpiston.suggestion import did_you_mean
from ballpiston.v1 import trace_pb2


def events_of(connection: Connection, request: Any) -> Iterator[dict[str, Any]]:
    """The start, then the events."""
    for message in connection.stream_again(request):
        if message.HasField("start"):
            yield record_of(message.start)
        yield from map(record_of, message.events)


def columns_of(
    connection: Connection, request: Any, names: Sequence[str]
) -> dict[str, npt.NDArray[Any]]:
    """Fields of all events as arrays, for orbits that are too long for dicts."""
    known = trace_pb2.TraceEvent.DESCRIPTOR.fields_by_name
    for name in names:
        if name not in known:
            raise ValueError(f"an event has no field {name!r}{did_you_mean(name, list(known))}")
    values: dict[str, list[Any]] = {name: [] for name in names}
    for message in connection.stream_again(request):
        for name, column in values.items():
            column.extend(_column(message.events, name, known[name].has_presence))
    arrays = {name: np.array(column) for name, column in values.items()}
    if "event" in arrays:
        arrays["event"] = np.array(trace_pb2.TraceEvent.Kind.keys())[arrays["event"]]
    return arrays


def _column(events: Any, name: str, is_optional: bool) -> list[Any]:
    if is_optional:
        return [getattr(e, name) if e.HasField(name) else np.nan for e in events]
    return [getattr(e, name) for e in events]
