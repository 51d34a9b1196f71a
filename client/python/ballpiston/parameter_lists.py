"""Lists of parameters, as callers write them in Python or as on the command line.

    0.5296                     a number
    [0.1, 0.05], range(1, 5)   any sequence or iterator of numbers
    np.linspace(0.1, 0.4, 4)   a one-dimensional array
    "0.1:0.4:4"                the command line's text: a,b,c or from:to:count or
                               from:to:count:log, or a mixture

A text gives the same doubles as the command line: inner numbers of from:to:count are rounded to 15
digits, so that "0.01:0.49:49" has the doubles that are nearest to its decimal fractions. The
numbers of np.linspace may differ from them in the last bit.

A table of points has a row for each point and a column for each parameter. Only the form is checked
here. The server judges the values.
"""

import math
import numbers
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ballpiston.point import PARAMETERS
from ballpiston.suggestion import did_you_mean

Numbers = Union[float, str, Iterable[float], "npt.NDArray[np.floating]"]
Shapes = Union[int, str, Iterable[Union[int, str]]]
Points = Any  # a pandas.DataFrame, a mapping of columns, or an iterable of mappings
# Least and most of the protocol's integers.
INT64 = (-(2**63), 2**63 - 1)
UINT64 = (0, 2**64 - 1)

_MOST = 100_000  # values of a list
_NO_LISTS = (bytes, bytearray, Mapping)  # iterable, but not lists of numbers
_NUMBER_CHARACTERS = frozenset("0123456789+-.eE")
_NUMBER = re.compile(r"-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def number_list(name: str, value: Numbers) -> list[float]:
    """The numbers of one parameter, which `name` names in errors. Raises TypeError: a value is not
    a number; ValueError: a text does not have the form of a list."""
    if isinstance(value, str):
        return _parsed_list(name, value)
    return [real_number(name, item) for item in _items(name, value)]


def shape_list(name: str, value: Shapes) -> list[str]:
    """Shapes of a gas: 8 or "8" is a chain of 8 cells, "10x5" a lattice of 10 columns, 5 rows."""
    if isinstance(value, str):
        return [shape for item in value.split(",") for shape in _parsed_shapes(name, item)]
    shapes: list[str] = []
    for item in _items(name, value):
        shapes += _parsed_shapes(name, item) if isinstance(item, str) else [_chain(name, item)]
    return shapes


def whole_number(name: str, value: object, least: float = -math.inf, most: float = math.inf) -> int:
    """10000, 1e4 or np.int64(10000), as an int. Raises TypeError: not a number; ValueError: a
    number that is not whole, or not from `least` to `most`."""
    real = real_number(name, value := _scalar(value))
    if isinstance(value, numbers.Integral):
        number = int(value)
    elif real.is_integer():
        number = int(real)
    else:
        raise ValueError(f"{name} has to be a whole number, not {value!r}")
    if not least <= number <= most:
        raise ValueError(f"{name} has to be from {least} to {most}, not {value!r}")
    return number


def real_number(name: str, value: object) -> float:
    """A float. Raises TypeError: not a number; ValueError: an int beyond the range of double
    precision."""
    value = _scalar(value)
    of_other_kind = isinstance(value, (bool, np.bool_, np.timedelta64))
    if of_other_kind or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} has to be a number, not {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} exceeds the range of double precision") from None


def truth_value(name: str, value: object) -> bool:
    """The value as a bool. Raises a TypeError that names the argument unless the value is True or
    False: bool("no") would be True."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} has to be True or False, not {value!r}")
    return bool(value)


def _scalar(value: object) -> object:
    """The number in an array without dimensions; any other value as it is."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _items(name: str, value: object) -> list[object]:
    if isinstance(value := _scalar(value), numbers.Real):
        return [value]
    if isinstance(value, np.ndarray) and value.ndim != 1:
        raise ValueError(f"{name} has {value.ndim} dimensions; a list of parameters has one")
    if isinstance(value, _NO_LISTS) or not isinstance(value, Iterable):
        raise TypeError(f"{name} has to be a number or a list of numbers, not {value!r}")
    return list(value)


def _parsed_list(name: str, text: str) -> list[float]:
    values = [number for item in text.split(",") for number in _parsed_range(name, item)]
    if len(values) > _MOST:
        raise ValueError(f"{name}: {text!r} has more than {_MOST} numbers")
    return values


def _parsed_number(name: str, text: str) -> float:
    if not _NUMBER.fullmatch(text):
        raise ValueError(f"{name}: {text!r} is not a decimal number such as 0.1 or 1e-3")
    number = float(text)
    is_below = number == 0 and re.match("[^eE]*[1-9]", text)
    if is_below or math.isinf(number):
        raise ValueError(
            f"{name}: {text!r} is beyond double precision; permitted: 0, or an absolute value from "
            "5e-324 to 1.79e308"
        )
    return number


def _parsed_range(name: str, text: str) -> list[float]:
    parts = text.split(":")
    if len(parts) == 1:
        return [_parsed_number(name, text)]
    is_logarithmic = parts[3:] == ["log"]
    if len(parts) < 3 or (len(parts) > 3 and not is_logarithmic):
        raise ValueError(
            f"{name}: {text!r} is not a range; write from:to:count or from:to:count:log"
        )
    first, last = _parsed_number(name, parts[0]), _parsed_number(name, parts[1])
    count = whole_number(f"{name}: the count of {text!r}", _parsed_number(name, parts[2]), 1, _MOST)
    if count == 1 and first != last:
        raise ValueError(
            f"{name}: {text!r} has two different ends and a count of 1; permitted: a count of at "
            "least 2, or equal ends"
        )
    if is_logarithmic and min(first, last) <= 0:
        raise ValueError(f"{name}: {text!r} is logarithmic, so both ends have to be above 0")
    return _range(first, last, count, is_logarithmic)


def _range(first: float, last: float, count: int, is_logarithmic: bool) -> list[float]:
    steps = count - 1
    if steps == 0:
        return [first]
    if is_logarithmic:
        # Rounded, because C libraries differ in the last bits of a power. The ratio of the ends may
        # be beyond the range of a float.
        shares = [i / steps for i in range(1, steps)]
        powers = [math.pow(first, 1 - share) * math.pow(last, share) for share in shares]
        inner = [float(f"{power:.12g}") for power in powers]
    else:
        inner = [float(f"{((steps - i) * first + i * last) / steps:.15g}") for i in range(1, steps)]
    return [first, *inner, last]


def _parsed_shapes(name: str, text: str) -> list[str]:
    """A text that is neither a number nor a range, such as the lattice 10x10, is not changed: the
    server checks it."""
    if ":" in text or set(text) <= _NUMBER_CHARACTERS:
        return [_chain(name, number) for number in _parsed_range(name, text)]
    return [text]


def _chain(name: str, value: object) -> str:
    number = real_number(name, value)
    # Those of a logarithmic range are rounded.
    if not math.isfinite(number) or abs(number - round(number)) > 1e-12 * abs(number):
        raise ValueError(f"{name} has to have whole numbers, not {value!r}")
    return str(round(number))


def add_list(grid: Any, parameter: str, values: Any, name: str = "") -> None:
    """Adds the values to the list of a Grid. `name` names them in errors."""
    read: Callable[[str, Any], Any] = shape_list if parameter == "cells" else number_list
    getattr(grid, parameter).extend(read(name or parameter, values))


def add_points(points: Points, grid: Any) -> None:
    """Adds the columns to the lists of a Grid, and their names to its table. Raises TypeError: not
    a table, or a column that is also given as a list; ValueError: an unknown column, a row that
    lacks a column, or no row."""
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
        ranges = [value for value in values if name == "cells" and ":" in str(value)]
        if ranges:
            raise ValueError(f"{of_column} has the range {ranges[0]!r}; permitted: one shape a row")
        add_list(grid, name, values, of_column)
        grid.table.append(name)


def _columns(points: Points) -> dict[str, list[Any]]:
    if isinstance(points, Mapping) or hasattr(points, "columns"):
        for name in points:
            column = points[name]
            if isinstance(column, (str, *_NO_LISTS)) or not isinstance(column, Iterable):
                raise TypeError(f"points, column {name} has to be a list, not {column!r}")
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
