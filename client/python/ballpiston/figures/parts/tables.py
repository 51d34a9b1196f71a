"""Tables: named columns of equal length. A figure's data are tables by name of file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ballpiston.closed_forms import ClosedForms
from ballpiston.point import Point
from ballpiston.result import Result
from ballpiston.table_file import Table as Table

FloatArray = npt.NDArray[np.float64]
Tables = dict[str, Table]

_ESTIMATE = ("name", "value", "standard_error", "exact", "noise_floor", "limit")


def table(rows: Iterable[Mapping[str, Any]], names: Iterable[str] = ()) -> Table:
    """Of rows with the same names; `names` are those of a table without rows. What is None becomes
    NaN."""
    rows = list(rows)
    names = rows[0] if rows else names
    return {n: np.array([np.nan if r[n] is None else r[n] for r in rows]) for n in names}


def stacked(tables: Iterable[Table]) -> Table:
    """One table below the other."""
    tables = list(tables)
    return {n: np.concatenate([t[n] for t in tables]) for n in (tables[0] if tables else ())}


def rows(whole: Table, **wanted: Any) -> Table:
    """The rows in which each named column has the wanted value."""
    length = len(next(iter(whole.values()), ()))
    mask = np.ones(length, dtype=bool)
    for name, value in wanted.items():
        mask &= whole[name] == value
    return {name: column[mask] for name, column in whole.items()}


def distinct(column: Iterable[Any]) -> list[Any]:
    """The values, in the order of their first appearance."""
    return list(dict.fromkeys(column))


def estimates(result: Result) -> Table:
    """One row for each estimate of each point, with the point's parameters."""

    return _of_points(
        result,
        lambda point: [
            table({name: getattr(e, name) for name in _ESTIMATE} for e in point.estimates.values())
        ],
    )


def curves(result: Result, *names: str) -> Table:
    """One row for each time, or position, of each curve of each point; if there are names, of these
    curves only. Functions of time and of the position do not fit into one table."""

    def of(point: Point) -> list[Table]:
        return [
            {
                "name": np.full(len(c.x), c.name),
                "position" if c.time is None else "time": c.x,
                "value": c.value,
                "standard_error": c.standard_error,
                "limit": c.limit,
            }
            for c in point.curves
            if not names or c.name in names
        ]

    return _of_points(result, of)


def histograms(result: Result) -> Table:
    """One row for each bin of each histogram of each point."""

    def of(point: Point) -> list[Table]:
        return [
            {
                "name": np.full(len(h.counts), h.name),
                "sigma": np.full(len(h.counts), h.sigma),
                "time": np.full(len(h.counts), np.nan if h.time is None else h.time),
                "lower": h.edges[:-1],
                "upper": h.edges[1:],
                "count": h.counts,
                "density": h.density,
                "exact_density": h.expected_density,
            }
            for h in point.histograms
        ]

    return _of_points(result, of)


def closed_forms(forms: ClosedForms, *names: str) -> Table:
    """One row for each pair or, if a name has a value for each energy, for each pair and energy."""
    columns = [forms[name] for name in names]
    shape = np.broadcast_shapes(*(_as_matrix(column).shape for column in columns))
    return {n: np.broadcast_to(_as_matrix(c), shape).ravel() for n, c in zip(names, columns)}


def _as_matrix(column: FloatArray) -> FloatArray:
    return column[:, np.newaxis] if column.ndim == 1 else column


def _of_points(result: Result, of: Callable[[Point], list[Table]]) -> Table:
    parts: list[Table] = []
    for point in result:
        facts: dict[str, Union[float, str]] = dict(point.parameters)
        facts |= {"model": point.model, "samples": point.samples}
        for part in of(point):
            length = len(next(iter(part.values()), ()))
            parts.append({name: np.full(length, fact) for name, fact in facts.items()} | part)
    return stacked(parts)
