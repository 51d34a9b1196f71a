"""The finished points of a job, as NumPy arrays over the points, and their JSON document."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial
from html import escape
from itertools import islice
from operator import attrgetter
from pathlib import Path
from typing import Any, overload

import numpy.typing as npt
from google.protobuf import json_format

from ballpiston._version import __version__
from ballpiston.arrays import Arrays, arrays_of, by_name, only, parameter_arrays
from ballpiston.fields import FloatArray, Value, column, json_of, shown, spelled
from ballpiston.measured_functions import Curve, Histogram
from ballpiston.point import Point, measured_text, unknown_estimate
from ballpiston.table import frame_of, html_table, write_table
from ballpiston.v1 import ensemble_pb2, result_pb2
from ballpiston.whole_file import write_atomically

_MOST_ROWS = 20


def _shown_once(read: Callable[[Any], Value], doc: str) -> Value:
    """A read-only property of a Result. The function reads the value in the messages, once for each
    object."""

    def value(result: Result) -> Any:
        known = vars(result)
        if doc not in known:
            known[doc] = read(result.messages)
        return known[doc]

    return property(value, doc=doc)  # type: ignore[return-value]


class Result:
    """The finished points of a job, in the order of the grid (rho outermost).

    A name gives an array over the points, result["mean_hit_time"], and a number one Point.
    A value that does not exist at a point is NaN. The arrays of `parameters` and `samples` are
    read-only. All callers get the same `parameters`, `models` and `remarks`: copy them before you
    change them. Lengths are cells, masses are 1, the energy of a ball-piston pair is 1/2.

    Attributes:
        job: the message ballpiston.v1.EnsembleJob, as the job was when the result was fetched.
        messages: one message ballpiston.v1.PointResult for each point.
    """

    parameters = _shown_once(
        lambda points: {name: _fixed(a) for name, a in parameter_arrays(points).items()},
        "Arrays of rho, delta and of every other parameter that is used; `cells` as str.",
    )
    samples = _shown_once(
        lambda points: _fixed(column(points, "samples")),
        "First hits, orbits, replicas or collisions at each point.",
    )
    models = _shown_once(
        lambda points: [spelled(point, "model") for point in points],
        'The model that answered at each point, such as "billiard".',
    )
    remarks: list[list[str]] = _shown_once(
        lambda points: [list(point.remarks) for point in points],
        "Sentences about each point, for instance that its run was too short.",
    )
    job_name = shown(lambda job: str(job.name), "ensembleJobs/ID, for client.job.", "job")
    state = shown(lambda job: spelled(job, "state"), "When the result was fetched.", "job")
    specification = shown(attrgetter("spec"), "The question, for client.submit.", "job")

    def __init__(self, job: Any, messages: Sequence[Any]) -> None:
        self.job = job
        self.messages = list(messages)

    def __len__(self) -> int:
        return len(self.messages)

    def __iter__(self) -> Iterator[Point]:
        return (Point(message) for message in self.messages)

    @overload
    def __getitem__(self, key: str) -> FloatArray:
        ...

    @overload
    def __getitem__(self, key: int) -> Point:
        ...

    def __getitem__(self, key: str | int) -> FloatArray | Point:
        """The values of an estimate at all points, or one point. Raises KeyError: no point has an
        estimate of this name; IndexError: there are fewer points."""
        if isinstance(key, str):
            return self._column(key, "value")
        if isinstance(key, slice):
            raise TypeError(f"the key has to be the name of an estimate or a number, not {key!r}")
        return Point(self.messages[key])

    def __contains__(self, name: object) -> bool:
        return name in self.names

    @property
    def names(self) -> list[str]:
        """The names of the estimates that some point has."""
        return list(self._by_name)

    def error(self, name: str) -> FloatArray:
        """Standard errors (one sigma) of an estimate; NaN where there are too few samples."""
        return self._column(name, "standard_error")

    def exact(self, name: str) -> FloatArray:
        """Closed forms of an estimate; NaN where there is none."""
        return self._column(name, "exact")

    def z_score(self, name: str) -> FloatArray:
        """(value - exact)/standard error of an estimate."""
        return self._column(name, "z_score")

    def model_error(self, name: str) -> FloatArray:
        """Upper bounds of the difference between the model and the billiard, in the units of the
        value like its error. 0 for the billiard itself and for closed forms."""
        return self._column(name, "model_error")

    def noise_floor(self, name: str) -> FloatArray:
        """Of a distance between two laws: its mean if the laws were equal."""
        return self._column(name, "noise_floor")

    def limit(self, name: str) -> FloatArray:
        """What the limit delta -> 0 gives at each point."""
        return self._column(name, "limit")

    def histogram(
        self, name: str, *, sigma: int | None = None, time: float | None = None, point: int = 0
    ) -> Histogram:
        """A histogram of the point at this position, such as "alpha", an angle with the sign sigma
        of the piston's velocity, or "piston_energy" at the nearest time, in cells over unit speed.
        Raises KeyError: the point has no such histogram, or several; the message lists them."""
        return self[point].histogram(name, sigma, time)

    def curve(self, name: str, *, point: int = 0) -> Curve:
        """A curve of one point, such as "survival" or "temperature_profile". Raises KeyError: the
        point has no such curve; the message lists those that it has."""
        return self[point].curve(name)

    def arrays(self) -> Arrays:
        """Everything as a dict of arrays, as in an .npz file; arrays.py describes the layout."""
        return arrays_of(self.job, self.messages)

    def to_frame(self) -> Any:
        """A pandas DataFrame with one row for each point, and as columns the one-dimensional arrays
        of `arrays()`. Needs pandas."""
        return frame_of({name: a for name, a in self.arrays().items() if a.ndim == 1})

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file: NAME.json, which ballpiston.load reads again, or NAME.npz, arrays for
        numpy.load. An existing file is replaced. Raises ValueError: the name ends with neither
        .json nor .npz."""
        path = Path(path)
        if path.suffix == ".json":
            write_atomically(path, self._document().encode())
        elif path.suffix == ".npz":
            write_table(path, self.arrays())
        else:
            raise ValueError(f"{path}: the name of the file has to end with .json or .npz")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result):
            return NotImplemented
        return bool(self.job == other.job and self.messages == other.messages)

    def __repr__(self) -> str:
        lines = self._lines()
        widths = [max(map(len, column)) for column in zip(*lines)]
        aligned = ["  ".join(map(str.rjust, line, widths)) for line in lines]
        return "\n".join([self._heading(), *aligned, *self._ending()])

    def _repr_html_(self) -> str:
        titles, *rows = self._lines() or [[]]
        ending = "".join(f"<p>{escape(line)}</p>" for line in self._ending())
        return html_table(self._heading(), titles, rows) + ending

    def _lines(self) -> list[list[str]]:
        """The titles, then a line for each of the first points; nothing without a point."""
        rows = [_row(point) for point in islice(self, _MOST_ROWS)]
        titles = list(dict.fromkeys(title for row in rows for title in row))
        lines = [[row.get(title, "") for title in titles] for row in rows]
        return [titles, *lines] if lines else []

    def _ending(self) -> list[str]:
        more = [f"and {len(self) - _MOST_ROWS} more points"] if len(self) > _MOST_ROWS else []
        remarks = dict.fromkeys(remark for of_point in self.remarks for remark in of_point)
        return [*more, *(f"remark: {r}" for r in remarks), *warnings_of(self)[:_MOST_ROWS]]

    def _heading(self) -> str:
        return (
            f"{spelled(self.job.spec, 'experiment')}, {len(self)} of {self.job.progress.points} "
            f"points, seed {self.job.spec.seed}, engine {self.job.engine_version} "
            f"({self.job_name}, {self.state})"
        )

    def _document(self) -> str:
        """As `ballpiston result JOB --format json` prints it, one point a line. Messages have the
        protocol's own field names; fields with their default value are written too; 64-bit
        integers are strings, as JSON of Protocol Buffers has it."""
        points = ",\n".join(json.dumps(json_of(message)) for message in self.messages)
        return (
            f'{{"client_version": {json.dumps(__version__)},\n'
            f'"job": {json.dumps(json_of(self.job))},\n"points": [\n{points}\n]}}\n'
        )

    @cached_property
    def _by_name(self) -> dict[str, list[list[Any]]]:
        return by_name(self.messages, "estimates")

    def _column(self, name: str, field: str) -> FloatArray:
        """A field of an estimate at each point."""
        if name not in self._by_name:
            raise KeyError(unknown_estimate(name, self.names))
        return column(map(only, self._by_name[name]), field)


def _fixed(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Makes the array read-only, because all callers get the same one."""
    array.flags.writeable = False
    return array


def _row(point: Point) -> dict[str, str]:
    row = {k: v if isinstance(v, str) else f"{v:.6g}" for k, v in point.parameters.items()}
    row["model"] = point.model
    row["samples"] = f"{point.samples:.15g}"
    for estimate in point.estimates.values():
        row[estimate.name] = measured_text(estimate.value, estimate.standard_error)
        if estimate.z_score is not None:
            row[estimate.name] += f" (z {estimate.z_score:+.2f})"
    return row


def warnings_of(result: Result) -> list[str]:
    """A sentence for each point whose orbits left the cell."""
    lost = "orbits left the cell; this is a defect: do not use the point"
    escapes = [(message.index, message.health.escapes) for message in result.messages]
    return [f"warning: point {i}: {count:.15g} {lost}" for i, count in escapes if count]


def load(path: str | os.PathLike[str]) -> Result:
    """A result from a JSON file that `result.save` or `ballpiston result JOB --format json` wrote.
    Needs no server. Raises ValueError: the file is not a saved result, for instance one with arrays
    (.npz), which numpy.load reads; OSError: the file cannot be read."""
    path = Path(path)
    data = path.read_bytes()
    if data.startswith(b"PK\x03\x04"):  # an archive
        raise ValueError(
            f"{path} contains arrays: numpy.load reads it. ballpiston.load reads the JSON files "
            'that result.save("NAME.json") and ballpiston result JOB --format json write'
        )
    try:
        document = json.loads(data)
        read = partial(json_format.ParseDict, ignore_unknown_fields=True)
        job = read(document["job"], ensemble_pb2.EnsembleJob())
        points = [read(point, result_pb2.PointResult()) for point in document["points"]]
    except (ValueError, KeyError, TypeError, AttributeError, json_format.ParseError) as error:
        raise ValueError(f"{path} is not a saved result: {error!r}") from error
    return Result(job, points)
