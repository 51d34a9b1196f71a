"""Cumulants of the charge through chains of the jump process against 1/N, and their limits

N c_n/(kappa_0 t): the cumulants of the energy that passes through a chain of N cells in a long time
t, over the conductivity kappa_0 at temperature 1, each divided by its limit of the additivity
principle. Lines are polynomials in 1/N. Time on one core: quick 10 s, default 2 min, full 12 min.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ballpiston.client import Client
from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO, answer
from ballpiston.figures.parts.charge import growth
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, rows, table
from ballpiston.parameter_lists import Shapes
from ballpiston.point import Point

EFFORT = {
    "quick": {"cells": "4,6,8,12", "collisions": 2e7},
    "full": {"cells": "4,6,8,12,16,24,32,64", "collisions": 1e9},
}

_RATIO = 1 - 0.0018073  # the chain's conductivity over the static one (docs/conductivity.md)
_NODES = 40  # of Gauss's quadrature
_DEGREE = 2  # of the polynomials in 1/N
_FIRST_WINDOW = 1  # of the growth: one relaxation time


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
    question = {"rho": rho, "delta": delta, "cells": cells, "hot": hot, "cold": cold}
    question |= {"model": "markov", "collisions": collisions, "seed": seed}
    result = answer(client, "gas-conduction", **question)
    found = table(row for point in result for row in _scaled(point, (hot + cold) / 2))
    return {"full-counting": found, "full-counting-limits": extrapolated(found, hot, cold)}


def limits(hot: float, cold: float) -> FloatArray:
    """N c_n/(kappa_0 t) for n = 1 to 4 by the additivity principle, with the conductivity
    kappa_0 sqrt(T) and the mobility 2 kappa_0 T^(5/2) (Bodineau and Derrida 2004)."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    t = (hot + cold) / 2 + (hot - cold) / 2 * nodes
    i1, i2, i3, i4 = (
        (hot - cold) / 2 * weights @ (np.sqrt(t) * (2 * t**2.5) ** (n - 1)) for n in range(1, 5)
    )
    third = 3 * (i3 * i1 - i2**2) / i1**3
    fourth = 3 * (5 * i4 * i1**2 - 14 * i1 * i2 * i3 + 9 * i2**3) / i1**5
    return np.array([i1, i2 / i1, third, fourth])


def extrapolated(found: Table, hot: float, cold: float) -> Table:
    """The polynomials a0 + a1/N + a2/N^2, the error of a0, and the limits. Cumulants of fewer than
    four chains have no row."""
    fitted = []
    for order, limit in enumerate(limits(hot, cold), 1):
        part = rows(found, order=order)
        if len(part["cells"]) <= _DEGREE + 1:
            continue
        terms = fits.powers(1 / part["cells"].astype(float), _DEGREE)
        fit = fits.linear(terms, part["value"], part["standard_error"])
        row = {"order": order, "limit": limit}
        row |= {f"a{k}": coefficient for k, coefficient in enumerate(fit.coefficients)}
        row |= {"standard_error": fit.errors[0], "chi_squared": fit.chi_squared}
        fitted.append(row | {"freedom": fit.freedom})
    return table(fitted)


def _scaled(point: Point, temperature: float) -> list[dict[str, float]]:
    """One row for each cumulant of which there is an error."""
    cells = int(point.parameters["cells"])
    ratio = point.estimates["conductivity_ratio"].value
    static = point.estimates["conductivity"].value / ratio / np.sqrt(temperature)
    unit = cells / (_RATIO * static)
    current = point.estimates["heat_current"]
    assert current.standard_error is not None
    values = {1: (current.value, current.standard_error)}
    for order in (2, 3, 4):
        grown = growth(point, order)
        if len(grown["time"]) > _FIRST_WINDOW:
            chosen = grown["value"][_FIRST_WINDOW], grown["standard_error"][_FIRST_WINDOW]
            values[order] = chosen
    return [
        {"cells": cells, "order": n, "value": unit * value, "standard_error": unit * error}
        for n, (value, error) in values.items()
    ]


@style.styled
def draw(tables: Tables) -> Figure:
    """One panel for each cumulant."""
    figure = style.picture(960, 720)
    panels = figure.subplots(2, 2)
    names = ("mean", "variance", "third cumulant", "fourth cumulant")
    for order, (axes, name) in enumerate(zip(panels.flat, names), 1):
        style.title(axes, "abcd"[order - 1], name)
        fit = rows(tables["full-counting-limits"], order=order)
        if len(fit["order"]):
            _draw_cumulant(axes, rows(tables["full-counting"], order=order), fit)
    style.outer_labels(panels, "1/N", "over its limit")
    return figure


def _draw_cumulant(axes: Any, part: Table, fit: Table) -> None:
    limit = fit["limit"][0]
    share = 1 / part["cells"].astype(float)
    x = np.linspace(0, 1.05 * share.max(), 100)
    curve = fits.powers(x, _DEGREE) @ [fit[f"a{k}"][0] for k in range(_DEGREE + 1)]
    style.level(axes, 1, color=style.ORANGE, label=f"limit {limit:.5g}")
    axes.plot(x, curve / limit, color=style.GREY)
    error = part["standard_error"] / limit
    style.error_points(axes, share, part["value"] / limit, error, style.BLUE)
    extrapolated_error = fit["standard_error"] / limit
    end = {"color": style.GREEN, "label": "N → ∞"}
    style.error_points(axes, [0], fit["a0"] / limit, extrapolated_error, **end)
    axes.set_xlim(-0.02 * x[-1], x[-1])
    axes.legend()
