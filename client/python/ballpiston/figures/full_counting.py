"""Cumulants of the charge through chains of the jump process against 1/N, and their limits

N c_n/(kappa_0 t): the cumulants of the energy that passes through a chain of N cells in a long time
t, over the conductivity kappa_0 at temperature 1, each divided by its limit of the additivity
principle. Lines are polynomials in 1/N. Time on one core: quick 30 s, default 3 min, full 10 min.
"""

import numpy as np

from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO, Client, Shapes, answer, check_chains
from ballpiston.figures.parts.charge import combined, correlations
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, groups, measured
from ballpiston.figures.parts.tables import pick, rows, stacked, table
from ballpiston.point import Point

EFFORT = {
    "quick": {"cells": "4,6,8,12", "collisions": 8e7},
    "full": {"cells": "4,6,8,12,16,24,32,64", "collisions": 3e8},
}

_RATIO = 1 - 0.0018073  # the chain's ratio (docs/research/conductivity.md)
_CAPACITY = 1.5  # of a cell, for heat
_POINTS = 400  # of the grid of the slowest profile
_DEGREE = 2  # of the polynomials in 1/N
_WINDOWS = 5  # 1/2, 1, 2, 4 and 8 relaxation times


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.2,
    cells: Shapes = "4,6,8,12,16,24,32",
    hot: float = 1.5,
    cold: float = 0.5,
    collisions: float = 1e8,
    seed: int = 0,
) -> Tables:
    """The scaled cumulants of each chain, from `collisions` exchanges, and their extrapolations."""
    check_chains(cells)
    if hot == cold:
        raise ValueError(f"hot and cold have to differ; both are {hot:g}")
    question = {"rho": rho, "delta": delta, "cells": cells, "hot": hot, "cold": cold}
    question |= {"model": "markov", "collisions": collisions, "seed": seed}
    result = answer(client, "gas-conduction", **question)
    rate = slowest_rate(hot, cold)
    found = stacked(_scaled(point, (hot + cold) / 2, rate) for point in result)
    return {"full-counting": found, "full-counting-limits": extrapolated(found, hot, cold)}


def limits(hot: float, cold: float) -> FloatArray:
    """N c_n/(kappa_0 t) for n = 1 to 4 by the additivity principle, with the conductivity
    kappa_0 sqrt(T) and the mobility 2 kappa_0 T^(5/2) (Bodineau and Derrida 2004)."""
    # The integrals of sqrt(T) (2 T^(5/2))^(n - 1) over T.
    n = np.arange(1, 5)
    power = 2.5 * n - 1
    i1, i2, i3, i4 = 2.0 ** (n - 1) * (hot**power - cold**power) / power
    third = 3 * (i3 * i1 - i2**2) / i1**3
    fourth = 3 * (5 * i4 * i1**2 - 14 * i1 * i2 * i3 + 9 * i2**3) / i1**5
    return np.array([i1, i2 / i1, third, fourth])


def slowest_rate(hot: float, cold: float) -> float:
    """The least eigenvalue m of f'' = -m T^(-1/2) f, f(0) = f(1) = 0, where T^(3/2) is linear. The
    slowest temperature profile of a long chain decays at the rate m kappa_0/(1.5 N^2)."""
    x = np.arange(1, _POINTS) / _POINTS
    fourth_root = (hot**1.5 + (cold**1.5 - hot**1.5) * x) ** (1 / 6)
    second = 2 * np.eye(len(x)) - np.eye(len(x), k=1) - np.eye(len(x), k=-1)
    matrix = fourth_root[:, np.newaxis] * second * fourth_root * _POINTS**2
    return float(np.linalg.eigvalsh(matrix)[0])


def _scaled(point: Point, temperature: float, rate: float) -> Table:
    """One row for each cumulant and window. `time` is in units of the slowest decay; it is infinite
    for the current."""
    cells = int(point.parameters["cells"])
    ratio = point["conductivity_ratio"] * np.sqrt(temperature)
    kappa = _RATIO * point["conductivity"] / ratio
    unit = cells / kappa
    current = {"time": np.inf, "value": point["heat_current"]}
    found = [table([current | {"standard_error": point.error("heat_current")}])]
    found += [pick(combined(point, n, longer=2), slice(_WINDOWS)) for n in (2, 3, 4)]
    return stacked(
        {
            "cells": cells,
            "order": order,
            "time": grown["time"] * rate * kappa / (_CAPACITY * cells**2),
            "value": unit * grown["value"],
            "standard_error": unit * grown["standard_error"],
        }
        for order, grown in enumerate(found, 1)
    )


def transient(time: FloatArray) -> FloatArray:
    """What exp(-t) in a cumulant adds to [c_n(2 t) - c_n(t)]/t."""
    added: FloatArray = (np.exp(-2 * time) - np.exp(-time)) / time
    return added


def extrapolated(found: Table, hot: float, cold: float) -> Table:
    """Fits of a0 + a1/N + a2/N^2 + b transient, where b is 0 for the first two cumulants, and the
    limits. `plain_chi_squared` is that of a fit with b = 0."""
    fitted = []
    for order, limit in enumerate(limits(hot, cold), 1):
        part = rows(found, order=order)
        terms = np.vander(1 / part["cells"].astype(float), _DEGREE + 1, increasing=True)
        values = *measured(part), correlations(part["cells"], order)
        plain = fits.linear(terms, *values)
        fit = plain
        if order > 2:
            terms = np.column_stack([terms, transient(part["time"])])
            fit = fits.linear(terms, *values)
        row = {"order": order, "limit": limit, "standard_error": fit.errors[0]}
        names = [f"a{k}" for k in range(_DEGREE + 1)] + ["b"]
        row |= {"b": 0.0} | dict(zip(names, fit.coefficients))
        row |= {"chi_squared": fit.chi_squared, "freedom": fit.freedom}
        fitted.append(row | {"plain_chi_squared": plain.chi_squared})
    return table(fitted)


@style.styled
def draw(tables: Tables) -> style.Figure:
    """One panel for each cumulant. A point is the mean over the windows, without the transient."""
    names = ("mean", "variance", "third cumulant", "fourth cumulant")
    figure, panels = style.panels((960, 720), 2, 2, names)
    for order, axes in enumerate(panels.flat, 1):
        fit = rows(tables["full-counting-limits"], order=order)
        _draw_cumulant(axes, rows(tables["full-counting"], order=order), fit)
    figure.supxlabel("1/N")
    figure.supylabel("over its limit")
    return figure


def _draw_cumulant(axes: style.Axes, part: Table, fit: Table) -> None:
    if not len(part["cells"]):
        style.inside(axes, 0.5, 0.5, "not measured: too few collisions", ha="center")
        return
    limit, order = fit["limit"][0], int(fit["order"][0])
    settled = part | {"value": part["value"] - fit["b"][0] * transient(part["time"])}
    found = []
    for (cells,), chain in groups(settled, "cells"):
        values = *measured(chain), correlations(chain["cells"], order)
        mean = fits.linear(np.ones((len(chain["cells"]), 1)), *values)
        found.append({"share": 1 / cells} | mean.row("value"))
    means = table(found)
    x = np.linspace(0, 1.05 * means["share"].max(), 100)
    curve = np.polyval([fit[f"a{k}"][0] for k in range(_DEGREE, -1, -1)], x)
    style.level(axes, 1, color=style.ORANGE, label=f"limit {limit:.5g}")
    axes.plot(x, curve / limit, color=style.GREY)
    style.error_points(axes, means["share"], *measured(means, unit=limit), style.BLUE)
    end = measured(fit, "a0", unit=limit)
    style.error_points(axes, [0], *end, style.GREEN, "N → ∞")
    axes.set_xlim(-0.02 * x[-1], x[-1])
    style.widen(axes, 0.85, 1.3)
    axes.legend()
