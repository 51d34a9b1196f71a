"""A table of points: a row for each point, a column for each parameter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ballpiston.parameter_lists import number_list, shape_list
from ballpiston.point import PARAMETERS
from ballpiston.suggestion import did_you_mean

# A pandas.DataFrame, a mapping of columns, or an iterable of rows that are mappings.
Points = Any


def add_points(points: Points, grid: Any) -> None:
    """Adds the columns to the lists of a Grid, and their names to its table.

    Raises:
        TypeError: not a table, or a column that is also given as a list.
        ValueError: an unknown column, a row that lacks a column, or no row.
    """
    columns = _columns(points)
    if not columns or any(len(values) == 0 for values in columns.values()):
        raise ValueError("points has no row")
    for name, values in columns.items():
        if name not in PARAMETERS:
            hint = did_you_mean(str(name), PARAMETERS)
            raise ValueError(f"points: {name!r} is not a parameter{hint}")
        if len(getattr(grid, name)) > 0:
            raise TypeError(f"points has the column {name}, and {name} is given: give one of them")
        of_column = f"points, column {name}"
        if name == "cells":
            grid.cells.extend(shape_list(of_column, values))
        else:
            getattr(grid, name).extend(number_list(of_column, values))
        grid.table.append(name)


def _columns(points: Points) -> dict[str, list[Any]]:
    if isinstance(points, Mapping) or hasattr(points, "columns"):
        for name in points:
            if not isinstance(points[name], Iterable):
                raise TypeError(f"points, column {name} has to be a list, not {points[name]!r}")
        return {name: list(points[name]) for name in points}
    rows = list(points) if isinstance(points, Iterable) else [points]
    if not all(isinstance(row, Mapping) for row in rows):
        raise TypeError(
            "points has to be a pandas.DataFrame, a dict of columns or a list of dicts, not "
            + type(points).__name__
        )
    names = list(rows[0]) if rows else []
    for number, row in enumerate(rows):
        if set(row) != set(names):
            raise ValueError(
                f"points, row {number}: has the keys {', '.join(row)}; row 0 has {', '.join(names)}"
            )
    return {name: [row[name] for row in rows] for name in names}
