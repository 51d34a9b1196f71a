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

import json
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston._version import __version__
from ballpiston.fields import FloatArray, column, json_of, spelled, value_of
from ballpiston.point import ESTIMATE_FIELDS, PARAMETERS, parameters_of

Arrays = dict[str, npt.NDArray[Any]]

_SIGNS = {1: "_plus", -1: "_minus"}


def arrays_of(job: Any, points: Sequence[Any]) -> Arrays:
    """Of an EnsembleJob and its PointResults."""
    provenance = {
        "job": job.name,
        "engine_version": job.engine_version,
        "client_version": __version__,
        "spec": json_of(job.spec),
    }
    measured = {
        **_estimates(points),
        **_parts(points, "kl_divergence", ("noise_error", "cells")),
        **_parts(points, "health", ("escapes", "max_energy_error")),
        **_histograms(points),
        **_curves(points),
    }
    return {
        "index": np.array([point.index for point in points], dtype=np.int64),
        **parameter_arrays(points),
        "model": np.array([spelled(point, "model") for point in points], dtype=np.str_),
        "samples": column(points, "samples"),
        **{name: array for name, array in measured.items() if not np.all(np.isnan(array))},
        "provenance": np.array(json.dumps(provenance)),
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


def by_name(
    points: Sequence[Any], part: str, name_of: Callable[[Any], str] = attrgetter("name")
) -> dict[str, list[list[Any]]]:
    """The messages in the field `part` of all points. For each name: a list with an item for each
    point, the list of the point's messages of this name."""
    found: dict[str, list[list[Any]]] = {}
    for i, point in enumerate(points):
        for message in getattr(point, part):
            if (name := name_of(message)) not in found:
                found[name] = [[] for _ in points]
            found[name][i].append(message)
    return found


def only(found: list[Any]) -> Any:
    """The only message, or None."""
    return found[0] if found else None


def _estimates(points: Sequence[Any]) -> dict[str, FloatArray]:
    arrays = {}
    for name, found in by_name(points, "estimates").items():
        estimates = [only(of_point) for of_point in found]
        arrays[name] = column(estimates, "value")
        arrays |= {f"{name}_{field}": column(estimates, field) for field in ESTIMATE_FIELDS}
    return arrays


def _parts(points: Sequence[Any], part: str, fields: Sequence[str]) -> dict[str, FloatArray]:
    """The arrays of these fields of the message `part`, which a point may lack."""
    messages = [value_of(point, part) for point in points]
    return {f"{part}_{field}": column(messages, field) for field in fields}


def _histograms(points: Sequence[Any]) -> dict[str, FloatArray]:
    def name_of(histogram: Any) -> str:
        return f"histogram_{histogram.name}" + _SIGNS.get(histogram.sigma, "")

    arrays = {}
    for name, found in by_name(points, "histograms", name_of).items():
        has_times = any(h.HasField("time") for of_point in found for h in of_point)
        for suffix, field in (("counts", "counts"), ("expected", "expected_probabilities")):
            bins = _padded([[getattr(h, field) for h in of_point] for of_point in found], 3)
            arrays[f"{name}_{suffix}"] = bins if has_times else bins[:, 0]
        for bound in ("lower", "upper"):
            arrays[f"{name}_{bound}"] = column(map(only, found), bound)
        if has_times:
            arrays[f"{name}_time"] = _padded([column(of_point, "time") for of_point in found], 2)
    return arrays


def _curves(points: Sequence[Any]) -> dict[str, FloatArray]:
    arrays = {}
    for name, found in by_name(points, "curves").items():
        for field in ("time", "position", "value", "standard_error", "batches", "limit"):
            rows = [
                [value_of(at, field) for c in of_point for at in c.points] for of_point in found
            ]
            arrays[f"curve_{name}_{field}"] = _padded(rows, 2)
    return arrays


def _padded(rows: Sequence[Any], dimensions: int) -> FloatArray:
    """Nested lists of numbers as one array, with NaN where a list is shorter than the longest."""
    if dimensions == 1:
        return np.array(rows, dtype=np.float64)
    parts = [_padded(row, dimensions - 1) for row in rows]
    shapes = [part.shape for part in parts] or [(0,) * (dimensions - 1)]
    padded = np.full((len(parts), *np.max(shapes, axis=0)), np.nan)
    for array, part in zip(padded, parts):
        array[tuple(map(slice, part.shape))] = part
    return padded
