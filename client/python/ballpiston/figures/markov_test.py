"""Relative entropies of first hits above their noise, and whether they oscillate in log(delta)

The relative entropy of the ingoing law of first hits with respect to the equilibrium law h^(1),
minus its noise floor, with one standard error, against delta. One panel for each outgoing law
h^(n), one colour for each energy of the piston. The vertical axis is linear near 0, because noise
makes values near the floor negative, and logarithmic elsewhere. Lines join the points of one
energy. Time on two cores: quick 5 s, default 1 min, full 45 min.

The tables: `markov-test-excess` has the points, `-decay` their means over octaves of delta, `-fit`
the comparison of oscillating models (parts/oscillation.py), `-maxima` the maxima of the points.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ballpiston.figures.parts import oscillation, style
from ballpiston.figures.parts.asking import ENERGIES, RHO, Client, Numbers, answer, divergences
from ballpiston.figures.parts.tables import Table, Tables, distinct, groups, pick, rows, stacked

EFFORT = {
    "quick": {"delta": "0.1:0.325:16:log", "samples": 30_000, "synthetic": 20},
    "full": {"samples": 4_000_000},
}


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.03:0.325:44:log",
    epsilon: Numbers = ENERGIES,
    exponent: Numbers = "0,1,5,10",
    samples: float = 100_000,
    seed: int = 0,
    synthetic: int = 200,
) -> Tables:
    """`samples` are the first hits of each point, `synthetic` the repetitions that calibrate a
    probability."""
    question = {"rho": rho, "delta": delta, "epsilon": epsilon, "exponent": exponent}
    result = answer(client, "first-hit", samples=samples, seed=seed, **question)
    points = excess(divergences(result))
    return {
        "markov-test-excess": points,
        "markov-test-decay": decay(points),
        "markov-test-fit": oscillation.fits(points, synthetic),
        "markov-test-maxima": maxima(points),
    }


def excess(divergence: Table) -> Table:
    """The relative entropy minus its noise floor, with its standard error. If the two laws are
    equal, the standard error is the error of the floor."""
    return {name: divergence[name] for name in ("delta", "epsilon", "exponent")} | {
        "excess": divergence["value"] - divergence["noise_floor"],
        "standard_error": np.fmax(divergence["standard_error"], divergence["noise_error"]),
    }


def decay(points: Table) -> Table:
    """Does the excess decay differently if the piston is slower than the ball, epsilon < 1/4? The
    mean excess over the deltas of each octave below the largest delta, and the ratio to the mean of
    the first octave, if that mean is above 3 standard errors."""
    largest = points["delta"].max()
    found = []
    for (epsilon, exponent), series in groups(points, "epsilon", "exponent"):
        # With the factor a delta at the border of two octaves stays in its octave despite rounding.
        octave = np.floor(np.log2(largest / series["delta"]) * (1 - 1e-9)).astype(int)
        count = np.bincount(octave)
        k = np.flatnonzero(count)
        mean = np.bincount(octave, series["excess"])[k] / count[k]
        error = np.sqrt(np.bincount(octave, series["standard_error"] ** 2)[k]) / count[k]
        has_ratio = (k > 0) & (k[0] == 0) & (mean[0] > 3 * error[0])
        ratio = np.where(has_ratio, mean / mean[0], np.nan)
        found.append(
            {
                "epsilon": epsilon,
                "exponent": exponent,
                "lower_delta": largest / 2.0 ** (k + 1),
                "upper_delta": largest / 2.0**k,
                "points": count[k],
                "mean_excess": mean,
                "standard_error": error,
                "ratio": ratio,
                "ratio_error": np.hypot(error, ratio * error[0]) / mean[0],
            }
        )
    return stacked(found)


def maxima(points: Table) -> Table:
    """The maxima of the excess from the largest delta down, without a model. Their spacings in
    log(delta) or in 1/delta are constant if the oscillation is periodic in that variable. The
    equilibrium law, n = 1, is left out."""
    found: list[dict[str, Any]] = []
    for (epsilon, exponent), series in groups(points, "epsilon", "exponent"):
        falling = pick(series, np.argsort(-series["delta"], kind="stable"))
        x, y = np.log(falling["delta"]), falling["excess"]
        highest = () if exponent == 1 else _highest_points(y, falling["standard_error"])
        tops = np.array([_top(x, y, i) for i in highest])
        part = {"epsilon": epsilon, "exponent": exponent, "delta": np.exp(tops)}
        part["spacing_of_log_delta"] = -np.diff(tops, prepend=np.nan)
        part["spacing_of_inverse_delta"] = np.diff(np.exp(-tops), prepend=np.nan)
        found.append(part)
    return stacked(found)


def _highest_points(y: Any, error: Any) -> Iterator[int]:
    """The positions of the maxima. One counts if on both sides the excess falls by 15 percent and
    by 3 standard errors before it is higher again."""
    extreme = 0
    sign = -1  # `extreme` is the highest (1) or lowest (-1) point since the last turn
    for i in range(1, len(y)):
        low, high = (i, extreme) if sign > 0 else (extreme, i)
        certain = 3 * np.hypot(error[low], error[high])
        if sign * y[i] > sign * y[extreme]:
            extreme = i
        elif y[low] < 0.85 * y[high] and y[high] - y[low] > certain:
            if sign > 0:
                yield extreme
            extreme, sign = i, -sign


def _top(x: Any, y: Any, i: int) -> float:
    """x at the maximum of the parabola of log y through the point i and its neighbours."""
    if min(y[i - 1 : i + 2]) <= 0:
        return float(x[i])
    after, before = (np.diff(np.log(y[i - 1 : i + 2])) / np.diff(x[i - 1 : i + 2]))[::-1]
    if after == before:
        return float(x[i])
    half = (x[i + 1] - x[i - 1]) / 2
    return float((x[i] + x[i - 1]) / 2 - before * half / (after - before))


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["markov-test-excess"]
    exponents = distinct(data["exponent"])
    across = min(2, len(exponents))
    down = -(-len(exponents) // across)
    shared: dict[str, Any] = style.SHARED | {"sharey": True}
    size = max(640, 540 * across), 420 * down + 40
    figure, panels = style.panels(size, down, across, **shared)
    style.signed_log_axis(panels[0, 0], 2 * data["standard_error"].min())
    panels[0, 0].set_xscale("log")
    panels[0, 0].set_xlim(0.93 * data["delta"].min(), 1.07 * data["delta"].max())
    for axes, exponent in zip(panels.flat, exponents):
        style.level(axes, 0)
        joined: dict[str, Any] = {"fmt": "o-", "linewidth": 1, "markersize": 3}
        for part, *shown in style.series(rows(data, exponent=exponent), "epsilon", "ε"):
            error = part["standard_error"]
            style.error_points(axes, part["delta"], part["excess"], error, *shown, **joined)
        law = ", the equilibrium law" if exponent == 1 else ""
        style.inside(axes, 0.03, 0.92, f"n = {exponent:g}{law}")
        style.plain_log_ticks(axes.xaxis, (0.001, 0.003, 0.01, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3))
    figure.supxlabel("δ")
    figure.supylabel("relative entropy − noise floor")
    style.remove_empty(panels, len(exponents))
    style.top_legend(figure, panels[0, 0].get_legend_handles_labels()[0])
    return figure
