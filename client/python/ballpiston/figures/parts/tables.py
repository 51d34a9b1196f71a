"""Tables: named columns of equal length. A figure's data are tables by name of file."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ballpiston.closed_forms import ClosedForms
from ballpiston.fields import FloatArray as FloatArray
from ballpiston.point import Point
from ballpiston.result import Result
from ballpiston.table import Table as Table

Tables = dict[str, Table]

_ESTIMATE = ("name", "value", "standard_error", "exact", "noise_floor", "limit")


def table(rows: Iterable[Mapping[str, Any]], names: Iterable[str] = ()) -> Table:
    """The table of these rows: columns of these names, by default of all names in the rows. A value
    that is absent or None becomes NaN."""
    rows = list(rows)
    names = names or dict.fromkeys(n for row in rows for n in row)
    return {n: np.array([np.nan if row.get(n) is None else row[n] for row in rows]) for n in names}


def stacked(parts: Iterable[Mapping[str, Any]]) -> Table:
    """One table below the other. A single value in place of a column is repeated in all rows of its
    part. A part without columns has no rows."""
    tables = [dict(zip(part, np.broadcast_arrays(*part.values()))) for part in parts if part]
    return {n: np.concatenate([t[n] for t in tables]) for n in (tables[0] if tables else ())}


def pick(whole: Table, index: Any) -> dict[str, Any]:
    """The rows that an index of NumPy, such as a mask, selects; with a number, a dict of values."""
    return {name: column[index] for name, column in whole.items()}


def rows(whole: Table, **wanted: Any) -> Table:
    """The rows in which each named column has the wanted value."""
    mask = np.ones(len(next(iter(whole.values()), ())), dtype=bool)
    for name, value in wanted.items():
        mask &= whole[name] == value
    return pick(whole, mask)


def measured(
    part: Mapping[str, Any], name: str = "value", zero: Any = 0.0, unit: Any = 1.0
) -> tuple[FloatArray, FloatArray]:
    """A column less `zero`, in this unit, and its errors: the column NAME_error, if there is one,
    else `standard_error`."""
    error = part.get(f"{name}_error", part.get("standard_error"))
    return (part[name] - zero) / unit, error / unit


def distinct(column: Iterable[Any]) -> list[Any]:
    """The values, in the order of their first appearance."""
    return list(dict.fromkeys(column))


def groups(whole: Table, *names: str) -> Iterator[tuple[tuple[Any, ...], Table]]:
    """Each combination of values of these columns, and its rows."""
    for values in distinct(zip(*(whole[name] for name in names))):
        yield values, rows(whole, **dict(zip(names, values)))


def estimates(result: Result) -> Table:
    """One row for each estimate of each point, with the point's parameters."""
    return table(
        _facts(point) | {name: getattr(estimate, name) for name in _ESTIMATE}
        for point in result
        for estimate in point.estimates.values()
    )


def curves(result: Result, *names: str) -> Table:
    """One row for each time, or position, of each curve of each point; if there are names, of these
    curves only. Functions of time and of the position do not fit into one table."""
    return stacked(
        _facts(point)
        | {
            "name": curve.name,
            "position" if curve.time is None else "time": curve.x,
            "value": curve.value,
            "standard_error": curve.standard_error,
            "limit": curve.limit,
        }
        for point in result
        for curve in point.curves
        if not names or curve.name in names
    )


def histograms(result: Result) -> Table:
    """One row for each bin of each histogram of each point."""
    return stacked(
        _facts(point)
        | {
            "name": histogram.name,
            "sigma": histogram.sigma,
            "time": np.nan if histogram.time is None else histogram.time,
            "lower": histogram.edges[:-1],
            "upper": histogram.edges[1:],
            "count": histogram.counts,
            "density": histogram.density,
            "exact_density": histogram.expected_density,
        }
        for point in result
        for histogram in point.histograms
    )


def closed_forms(forms: ClosedForms, *names: str) -> Table:
    """One row for each pair or, if a name has a value for each energy, for each pair and energy."""
    matrices = [forms[name].reshape(len(forms), -1) for name in names]
    return dict(zip(names, map(np.ravel, np.broadcast_arrays(*matrices))))


def _facts(point: Point) -> dict[str, Any]:
    return point.parameters | {"model": point.model, "samples": point.samples}
