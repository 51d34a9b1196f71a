"""One point of the grid of a result."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

from ballpiston.fields import shown, spelled, value_of
from ballpiston.measured_functions import Curve, Histogram, choose_histogram, curve_of
from ballpiston.measured_functions import histograms_of
from ballpiston.suggestion import did_you_mean, no_such

_SMALLEST, _LARGEST = 1e-4, 1e7  # outside these a number has an exponent
_ROUNDING = 5e-13  # an error below this share of the value is that of rounding
# The parameters of a grid. The last one varies fastest.
PARAMETERS = ("rho", "delta", "epsilon", "exponent", "cells", "temperature", "hot", "cold")


@dataclass(frozen=True)
class Estimate:
    """A measured number. What does not exist is None.

    Attributes:
        value: of the quantity `name`.
        standard_error: one sigma; None if there are too few samples for one.
        exact: the closed form, if there is one.
        z_score: (value - exact)/standard_error.
        model_error: upper bound of the difference between the model and the billiard, in the units
            of the value like standard_error.
        noise_floor: of a distance between two laws, its mean if the laws were equal.
        limit: what the limit delta -> 0 gives here.
        batches: independent numbers behind the error: value +- t(batches - 1) standard_error, with
            Student's t; None if the error does not come from a scatter.
    """

    name: str
    value: float
    standard_error: float | None = None
    exact: float | None = None
    z_score: float | None = None
    model_error: float | None = None
    noise_floor: float | None = None
    limit: float | None = None
    batches: float | None = None

    def __str__(self) -> str:
        return f"{self.name} {measured_text(self.value, self.standard_error)}"


# All fields except the name and the value.
ESTIMATE_FIELDS = tuple(field.name for field in fields(Estimate))[2:]


def _estimate(message: Any) -> Estimate:
    facts = {field: value_of(message, field) for field in ESTIMATE_FIELDS}
    return Estimate(message.name, message.value, **facts)


def parameters_of(message: Any) -> dict[str, float | str]:
    """Of a PointResult: rho, delta and the optional ones that it has."""
    parameters = {name: value_of(message.parameters, name) for name in PARAMETERS}
    return {name: value for name, value in parameters.items() if value is not None}


class Point:
    """What was measured at one point, for instance result[0]["mean_hit_time"]."""

    parameters = shown(
        parameters_of, "The values of the parameters that the experiment uses, `cells` as text."
    )
    estimates: dict[str, Estimate] = shown(
        lambda point: {message.name: _estimate(message) for message in point.estimates},
        "All of them by name, in the order of the answer.",
    )
    index = shown(lambda point: int(point.index), "Position in the grid, rho outermost.")
    model = shown(
        lambda point: spelled(point, "model"), 'The model that answered, such as "billiard".'
    )
    reason = shown(lambda point: str(point.reason), "Why that model, if the server chose it.")
    samples = shown(
        lambda point: float(point.samples),
        "First hits, orbits, replicas or collisions behind the estimates.",
    )
    remarks: list[str] = shown(
        lambda point: list(point.remarks), "For instance that a run was too short."
    )
    histograms = shown(lambda point: histograms_of(point.histograms), "All of this point.")
    curves = shown(lambda point: list(map(curve_of, point.curves)), "All of this point.")

    def __init__(self, message: Any) -> None:
        self.message = message  # ballpiston.v1.PointResult

    def __getitem__(self, name: str) -> float:
        return self._named(name).value

    def error(self, name: str) -> float | None:
        """The standard error of an estimate, or None."""
        return self._named(name).standard_error

    def histogram(
        self, name: str, sigma: int | None = None, time: float | None = None
    ) -> Histogram:
        """One of them; see Result.histogram."""
        return choose_histogram(self.histograms, name, sigma, time)

    def curve(self, name: str) -> Curve:
        """The curve of this name. Raises KeyError: there is none."""
        messages = {message.name: message for message in self.message.curves}
        if name not in messages:
            raise KeyError(no_such("curve", name, "this point", messages))
        return curve_of(messages[name])

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={value}" for name, value in self.parameters.items())
        estimates = "".join(f"\n  {estimate}" for estimate in self.estimates.values())
        return f"<point {self.index}: {shown}; {self.model}>{estimates}"

    def _named(self, name: str) -> Estimate:
        estimates = self.estimates
        if name in estimates:
            return estimates[name]
        raise KeyError(unknown_estimate(name, list(estimates)))


def unknown_estimate(name: object, names: list[str]) -> str:
    """The message of a KeyError."""
    return f"there is no estimate {name!r}{did_you_mean(str(name), names)}; " + (
        f"the estimates are {', '.join(names)}" if names else "no point is finished"
    )


def measured_text(value: float, error: float | None = None) -> str:
    """A value to the digits that its standard error supports: 21.63 ± 0.12. Without an error it has
    six significant digits; with an error of 0, or of rounding only, twelve and no error."""
    if error is None or math.isnan(error):
        return f"{value:.6g}"
    if 0 <= error < _ROUNDING * abs(value):
        return f"{value:.12g}"
    if not (error > 0 and math.isfinite(error) and math.isfinite(value)):
        return f"{value:.6g} ± {error:.6g}"
    last = math.floor(math.log10(error)) - 1  # power of ten of the error's second digit
    size = max(abs(value), error)
    if _SMALLEST <= size < _LARGEST:
        decimals = max(0, -last)
        return f"{value:.{decimals}f} ± {error:.{decimals}f}"
    return f"{_scientific(value, last)} ± {_scientific(error, last)}"


def _scientific(x: float, last: int) -> str:
    digits = 0 if x == 0 else max(0, math.floor(math.log10(abs(x))) - last)
    return f"{x:.{digits}e}"
