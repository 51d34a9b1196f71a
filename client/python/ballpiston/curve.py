"""Curves of a point: functions of time, or of the position in a gas."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ballpiston.fields import FloatArray, column
from ballpiston.suggestion import no_such


@dataclass(frozen=True, eq=False)
class Curve:
    """A measured function.

    Attributes:
        name: "survival", the probability that ball and piston have not met up to this time;
            "energy_autocorrelation"; "mean_energy"; "temperature_profile" of a gas.
        time: in cells over unit speed; None of a function of the position.
        position: in cells from the left reservoir; None of a function of time.
        value: of the function.
        standard_error: one sigma; NaN where there is none.
        batches: how certain the standard error is, as in an estimate; NaN where it is not stated.
        limit: what the limit delta -> 0 gives here; NaN where it gives nothing.
    """

    name: str
    time: FloatArray | None
    position: FloatArray | None
    value: FloatArray
    standard_error: FloatArray
    batches: FloatArray
    limit: FloatArray

    @property
    def x(self) -> FloatArray:
        """The times or the positions."""
        if self.time is not None:
            return self.time
        return np.empty(0) if self.position is None else self.position


def curve_of(message: Any) -> Curve:
    """Of a message ballpiston.v1.Curve."""
    points = message.points
    x = "position" if any(point.HasField("position") for point in points) else "time"
    columns: dict[str, Any] = {"time": None, "position": None}
    for name in (x, "value", "standard_error", "batches", "limit"):
        columns[name] = column(points, name)
    return Curve(message.name, **columns)


def choose_curve(messages: Iterable[Any], name: str) -> Curve:
    """The curve of this name. Raises KeyError: there is none."""
    by_name = {message.name: message for message in messages}
    if name not in by_name:
        raise KeyError(no_such("curve", name, "this point", by_name))
    return curve_of(by_name[name])
