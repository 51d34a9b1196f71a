"""A result as a dict of NumPy arrays: the layout of `.npz` files.

    index, rho, delta, ...          (points,)  the parameters that are used; cells as str
    model, samples                  (points,)
    NAME, NAME_standard_error, NAME_exact, NAME_z_score, NAME_model_error, NAME_noise_floor,
    NAME_limit, NAME_batches        (points,)  for each estimate; NaN where absent
    kl_divergence_noise_error, kl_divergence_cells
                                    (points,)  if there is a divergence
    health_escapes, health_max_energy_error
                                    (points,)
    histogram_NAME_counts, _expected
                                    (points, bins), or (points, times, bins) with times
    histogram_NAME_lower, _upper    (points,)
    histogram_NAME_time             (points, times), with times
    curve_NAME_time or _position, _value, _standard_error, _batches, _limit
                                    (points, length)
    provenance                      ()  JSON: job, engine_version, client_version, spec

NAME of an angle's histogram ends with _plus or _minus, for sigma +1 and -1. Shorter histograms and
curves are padded with NaN. An array that would have no value at all is left out.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston._version import __version__
from ballpiston.curve import curve_of
from ballpiston.document import json_of
from ballpiston.point import ESTIMATE_FIELDS, PARAMETERS, parameters_of
from ballpiston.spelling import spelling
from ballpiston.v1 import spec_pb2

Array = npt.NDArray[Any]
Arrays = dict[str, Array]

_SIGNS = {1: "_plus", -1: "_minus"}


def arrays_of(job: Any, points: Sequence[Any]) -> Arrays:
    """Of an EnsembleJob and its PointResults."""
    return {
        "index": np.array([point.index for point in points], dtype=np.int64),
        **parameter_arrays(points),
        "model": _texts(spelling(spec_pb2.EnsembleSpec.Model, point.model) for point in points),
        "samples": _floats(point.samples for point in points),
        **_estimate_arrays(points),
        **_part_arrays(points, "kl_divergence", ("noise_error", "cells")),
        **_part_arrays(points, "health", ("escapes", "max_energy_error")),
        **_histogram_arrays(points),
        **_curve_arrays(points),
        "provenance": np.array(json.dumps(_provenance(job))),
    }


def parameter_arrays(points: Sequence[Any]) -> Arrays:
    """rho, delta and every other parameter that some point has."""
    rows = [parameters_of(point) for point in points]
    used = {"rho", "delta"}.union(*rows)
    return {
        name: np.array([row.get(name, "" if name == "cells" else np.nan) for row in rows])
        for name in PARAMETERS
        if name in used
    }


def optional_floats(messages: Iterable[Any], field: str) -> npt.NDArray[np.float64]:
    """A field that may be absent, of messages that may be None; NaN where absent."""
    return _floats(
        getattr(m, field) if m is not None and m.HasField(field) else np.nan for m in messages
    )


def _provenance(job: Any) -> dict[str, Any]:
    return {
        "job": job.name,
        "engine_version": job.engine_version,
        "client_version": __version__,
        "spec": json_of(job.spec),
    }


def _estimate_arrays(points: Sequence[Any]) -> Arrays:
    by_name = [{estimate.name: estimate for estimate in point.estimates} for point in points]
    arrays: Arrays = {}
    for name in dict.fromkeys(name for estimates in by_name for name in estimates):
        column = [estimates.get(name) for estimates in by_name]
        arrays[name] = _floats(np.nan if e is None else e.value for e in column)
        for field in ESTIMATE_FIELDS:
            _add_unless_empty(arrays, f"{name}_{field}", optional_floats(column, field))
    return arrays


def _part_arrays(points: Sequence[Any], part: str, fields: Sequence[str]) -> Arrays:
    """Arrays of these fields of `part`, a message that a point may have."""
    column = [getattr(point, part) if point.HasField(part) else None for point in points]
    arrays: Arrays = {}
    for field in fields:
        values = _floats(np.nan if found is None else getattr(found, field) for found in column)
        _add_unless_empty(arrays, f"{part}_{field}", values)
    return arrays


def _histogram_arrays(points: Sequence[Any]) -> Arrays:
    by_name = [_grouped(point.histograms, _histogram_name) for point in points]
    arrays: Arrays = {}
    for name in dict.fromkeys(name for groups in by_name for name in groups):
        column = [groups.get(name, []) for groups in by_name]
        arrays.update(_arrays_of_one_histogram(f"histogram_{name}", column))
    return arrays


def _arrays_of_one_histogram(name: str, column: list[list[Any]]) -> Arrays:
    """`column` has the histograms of each point that have this name: one, or one for each time."""
    has_times = any(h.HasField("time") for group in column for h in group)
    arrays: Arrays = {}
    for suffix, field in (("counts", "counts"), ("expected", "expected_probabilities")):
        rows = [[list(getattr(h, field)) for h in group] for group in column]
        values = _padded(rows, 3)
        if not has_times and values.size:
            values = values[:, 0, :]
        _add_unless_empty(arrays, f"{name}_{suffix}", values)
    for bound in ("lower", "upper"):
        arrays[f"{name}_{bound}"] = _floats(
            getattr(group[0], bound) if group else np.nan for group in column
        )
    if has_times:
        arrays[f"{name}_time"] = _padded([[h.time for h in group] for group in column], 2)
    return arrays


def _histogram_name(histogram: Any) -> str:
    return str(histogram.name) + _SIGNS.get(histogram.sigma, "")


def _curve_arrays(points: Sequence[Any]) -> Arrays:
    by_name = [{curve.name: curve_of(curve) for curve in point.curves} for point in points]
    arrays: Arrays = {}
    for name in dict.fromkeys(name for curves in by_name for name in curves):
        for field in ("time", "position", "value", "standard_error", "batches", "limit"):
            found = [getattr(curves.get(name), field, None) for curves in by_name]
            rows = [[] if row is None else row for row in found]
            _add_unless_empty(arrays, f"curve_{name}_{field}", _padded(rows, 2))
    return arrays


def _grouped(items: Iterable[Any], key: Callable[[Any], str]) -> dict[str, list[Any]]:
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def _padded(rows: list[Any], dimensions: int) -> Array:
    """Nested lists of numbers as one array, with NaN where a list is shorter than the longest."""
    shape = tuple(_longest(rows, depth) for depth in range(dimensions))
    array = np.full(shape, np.nan)
    _fill(array, rows)
    return array


def _longest(rows: Any, depth: int) -> int:
    if depth == 0:
        return len(rows)
    return max((_longest(row, depth - 1) for row in rows), default=0)


def _fill(array: Array, rows: Any) -> None:
    if array.ndim == 1:
        array[: len(rows)] = rows
        return
    for part, row in zip(array, rows):
        _fill(part, row)


def _add_unless_empty(arrays: Arrays, name: str, values: Array) -> None:
    if values.size and not np.all(np.isnan(values)):
        arrays[name] = values


def _floats(values: Iterable[float]) -> npt.NDArray[np.float64]:
    return np.array(list(values), dtype=np.float64)


def _texts(values: Iterable[str]) -> Array:
    return np.array(list(values), dtype=np.str_)
