"""Raw data behind the estimates: the collisions of a point's samples, and the events of an orbit of
the reference billiard."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston.connection import Connection
from ballpiston.fields import record_of
from ballpiston.suggestion import did_you_mean
from ballpiston.v1 import trace_pb2
from ballpiston.whole_file import whole_file

Records = npt.NDArray[Any]

_FIELDS = [field.name for field in trace_pb2.SampleCollisionsResponse.DESCRIPTOR.fields]
# By number of the field, from 1. All have 8 bytes.
_RECORD = np.dtype([(name, "<u8" if name == "sample" else "<f8") for name in _FIELDS])


class Collisions:
    """An iterator of structured arrays, each of at most 1,024 collisions in the order of samples.
    The server computes only as fast as they are read.

    The fields: sample, time (since the orbit's start), free_time, x, y, ball_vx, ball_vy, piston_vx,
    ball_vx_after, piston_vx_after, piston_energy, piston_energy_after.
    """

    def __init__(self, connection: Connection, spec: Any) -> None:
        self._messages = connection.stream_again(trace_pb2.SampleCollisionsRequest(spec=spec))

    def __iter__(self) -> Iterator[Records]:
        return self

    def __next__(self) -> Records:
        return _records_of(next(self._messages))

    def close(self) -> None:
        """Ends the reading before the last collision; the server stops too."""
        self._messages.close()

    def all(self) -> Records:
        """The rest as one array."""
        return np.concatenate([np.empty(0, _RECORD), *self])

    def to_parquet(self, path: Path | str) -> None:
        """Writes the rest as a file of columns: the whole file or none. Raises ModuleNotFoundError:
        this needs pandas and pyarrow. No collision was read."""
        import pandas
        import pyarrow as _  # pandas looks for it only after the collisions were read

        with whole_file(Path(path)) as part:
            pandas.DataFrame(self.all()).to_parquet(part, index=False)


def _records_of(message: Any) -> Records:
    """From the wire format, where a column is its number, its length in bytes and an array of
    little-endian numbers of 8 bytes: ten times as fast as through a list of numbers."""
    count = len(message.sample)
    length = max(1, ((8 * count).bit_length() + 6) // 7)  # bytes that the length takes
    layout = [("number", "u1"), ("length", f"V{length}"), ("values", "V8", (count,))]
    # NaN: columns that an older server does not send.
    records = np.full((count, len(_FIELDS)), np.nan).view(_RECORD)[:, 0]
    message.DiscardUnknownFields()  # columns of a newer server
    for column in np.frombuffer(message.SerializeToString(), layout):
        name = _FIELDS[(column["number"] >> 3) - 1]
        records[name] = column["values"].view(_RECORD[name])
    return records


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
            raise ValueError(f"an event has no field {name!r}{did_you_mean(name, known)}")
    values: dict[str, list[Any]] = {name: [] for name in names}
    for events in (message.events for message in connection.stream_again(request)):
        for name, column in values.items():
            if known[name].has_presence:
                column += [getattr(e, name) if e.HasField(name) else np.nan for e in events]
            else:
                column += [getattr(e, name) for e in events]
    arrays = {name: np.array(column) for name, column in values.items()}
    if "event" in arrays:
        arrays["event"] = np.array(trace_pb2.TraceEvent.Kind.keys())[arrays["event"]]
    return arrays
