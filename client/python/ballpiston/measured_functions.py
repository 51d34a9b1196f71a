"""Histograms and curves of a point. A curve is a function of time or of the position in a gas."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ballpiston.fields import FloatArray, column, value_of
from ballpiston.suggestion import no_such


@dataclass(frozen=True, eq=False)
class Histogram:
    """Equal bins. What lies beyond them was counted in the first or last bin.

    Attributes:
        name: the counted quantity: "alpha", an angle in radians, in first-hit; "piston_energy" in
            energy-relaxation; "ball_speed" and "piston_speed" in a gas.
        sigma: of an angle the sign of the piston's velocity, +1 or -1; else 0.
        time: at which it was counted, in cells over unit speed; None if it has no time.
        edges: of the bins, one more than bins.
        counts: in the bins; empty if the model has no samples.
        density: of the counts. Over the histograms of one name and time it integrates to 1: for an
            angle over both signs.
        expected: exact probabilities of the bins, of "piston_energy" those of the limit
            delta -> 0; empty if there are none.
        expected_density: `expected` over the width of the bins, to be drawn beside `density`.
    """

    name: str
    sigma: int
    time: float | None
    edges: FloatArray
    counts: FloatArray
    density: FloatArray
    expected: FloatArray
    expected_density: FloatArray

    @property
    def centers(self) -> FloatArray:
        """The middles of the bins."""
        middles: FloatArray = (self.edges[:-1] + self.edges[1:]) / 2
        return middles


def histograms_of(messages: Sequence[Any]) -> list[Histogram]:
    """Those of one point: the densities need the counts of both signs of an angle."""
    totals: defaultdict[tuple[str, float], float] = defaultdict(float)
    for message in messages:
        totals[message.name, message.time] += sum(message.counts)
    return [_histogram(message, totals[message.name, message.time]) for message in messages]


def choose_histogram(
    histograms: list[Histogram], name: str, sigma: int | None, time: float | None
) -> Histogram:
    """The only one of this name and sign; of several times the nearest one. Raises KeyError: there
    is none, or several; the message lists those to choose from."""
    named = [h for h in histograms if h.name == name]
    if not named:
        raise KeyError(no_such("histogram", name, "this point", (h.name for h in histograms)))
    is_timeless = time is not None and named[0].time is None
    found = [h for h in named if sigma in (None, h.sigma) and not is_timeless]
    if time is not None and found:
        distances = [abs((h.time or 0.0) - time) for h in found]
        nearest = found[distances.index(min(distances))].time
        found = [h for h in found if h.time == nearest]
    if len(found) == 1:
        return found[0]
    wrong = f"time={time!r}" if is_timeless else f"sigma={sigma!r}"
    problem = "several" if found else f"none with {wrong}"
    choices = " or ".join(dict.fromkeys(_choice(h) for h in found or named))
    raise KeyError(f"of the histogram {name!r} there are {problem}: choose {choices}")


def _choice(histogram: Histogram) -> str:
    """The arguments that choose this histogram."""
    sigma = f"sigma={histogram.sigma:+d}" if histogram.sigma else ""
    time = "" if histogram.time is None else f"time={histogram.time:.6g}"
    return ", ".join(filter(None, (sigma, time))) or "no sigma and no time"


def _histogram(message: Any, total: float) -> Histogram:
    counts = np.array(message.counts, dtype=np.float64)
    expected = np.array(message.expected_probabilities, dtype=np.float64)
    bins = max(len(counts), len(expected))
    width = (message.upper - message.lower) / bins if bins else np.nan
    density = counts / total / width if total > 0 else np.full(len(counts), np.nan)
    return Histogram(
        name=message.name,
        sigma=message.sigma,
        time=value_of(message, "time"),
        edges=message.lower + np.arange(bins + 1) * width if bins else np.empty(0),
        counts=counts,
        density=density,
        expected=expected,
        expected_density=expected / width,
    )


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
