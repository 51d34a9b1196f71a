"""Slow pistons between two reservoirs: the variance of the charge grows as t ln t

The charge Q is the energy that passes through one cell from a hot to a cold reservoir in a time t.
Slow pistons block it for long times. The law is that Var(Q)/t grows by 2 a J^2 in each e-fold of t,
with the current J and a = lim s P(a piston exchanges nothing during s), summed over both pistons.

a  Var(Q)/t over its value at the first window: the billiard at the first delta, in equilibrium, and
   the jump process; errors are those of the change from the first window
b  the growth of Var(Q)/t over the law, at each cold temperature and at each delta

The program `slow_pistons` measures a. Time on one core: quick 20 s, default 3 min, full 20 min.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer, number_list
from ballpiston.figures.parts.charge import combined
from ballpiston.figures.parts.programs import table_of
from ballpiston.figures.parts.tables import Table, Tables, curves, groups, measured
from ballpiston.figures.parts.tables import pick, rows, stacked, table
from ballpiston.point import Point
from ballpiston.result import Result

EFFORT = {
    "quick": {"delta": "0.2", "cold": "0.1,0.01", "samples": 1e5, "blocks": 4},
    "full": {"samples": 3e6, "blocks": 20},
}

_BLOCK = 1e6  # of time, in which the program measures a
_IDLE_TIME = 64.0  # s at which a is taken
_FROM, _TO = 3, 300  # the windows of a fit: 4 to 256 stretches, which are half a relaxation time
_SHOWN = slice(2, 10)  # of the windows, from 4 stretches on
_CURVE = "charge_cumulant_2_by_window"
_COLD = 0.01  # where delta varies, and of the jump process
_NOT_MEASURED = "not measured: too few samples"


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.15,0.1",
    cold: Numbers = "0.5,0.1,0.03,0.01,0.001",
    samples: float = 3e5,
    blocks: int = 6,
    seed: int = 0,
) -> Tables:
    """The variance by window, a of each piston, and the growth beside its law. The hot temperature
    is 1. All of `cold` are measured at the first delta, all of `delta` at the cold temperature
    0.01. `samples` are stretches of the chain; `blocks`, of a million units of time, measure a."""

    def gas(model: str, delta: Numbers, cold: Numbers) -> Result:
        question = {"rho": rho, "delta": delta, "cells": 1, "hot": 1, "cold": cold, "seed": seed}
        return answer(client, "gas-conduction", model=model, samples=samples, **question)

    one, *others = number_list("delta", delta)
    cases = [gas("billiard", one, cold)] + ([gas("billiard", others, _COLD)] if others else [])
    points = [point for result in cases for point in result]
    controls = [gas("billiard", one, 1), gas("markov", one, _COLD)]
    idle = [_idle(point, blocks, seed) for point in points]
    return {
        "slow-pistons-windows": stacked([curves(r, _CURVE) for r in cases + controls]),
        "slow-pistons-idle": stacked(idle),
        "slow-pistons": table(map(_growth_and_law, points, idle)),
        "slow-pistons-controls": table(
            _growth(point) | {"model": point.model} for result in controls for point in result
        ),
    }


def _idle(point: Point, blocks: int, seed: int) -> Table:
    """a of each piston, at several times s."""
    case = {name: point.parameters[name] for name in ("delta", "cold")}
    gas = {"rho": point.parameters["rho"]} | case
    found = table_of("slow_pistons", "idle", **gas, block=_BLOCK, blocks=blocks, seed=seed)
    return stacked([case | found])


def _growth_and_law(point: Point, idle: Table) -> dict[str, float]:
    """The growth in an e-fold of the window, and 2 a J^2."""
    pistons = rows(idle, time=_IDLE_TIME)
    share, share_error = pistons["limit"].sum(), np.hypot(*pistons["limit_error"])
    current = point["heat_current"]
    law, law_error = 2 * share * current**2, 2 * share_error * current**2
    row = _growth(point)
    ratio = row["growth"] / law
    error = np.hypot(row["growth_error"] / law, ratio * law_error / law)
    row |= {"current": current, "a": share, "a_error": share_error, "law": law}
    return row | {"ratio": ratio, "ratio_error": float(error)}


def _growth(point: Point) -> dict[str, float]:
    """A fit of v(2 t) - v(t) = growth ln 2 + b/t, where v is Var(Q)/t; and v at the first window of
    the fit, as `variance`. NaN if too few windows were measured."""
    found = combined(point, 2, longer=1)
    shortest = found["time"].min(initial=np.inf)
    fitted = pick(found, (found["time"] > _FROM * shortest) & (found["time"] < _TO * shortest))
    time = fitted["time"]
    terms = np.column_stack([np.full(len(time), np.log(2)), 1 / time])
    fit = fits.linear(terms, fitted["value"], fitted["standard_error"])
    row: dict[str, float] = {name: float(point.parameters[name]) for name in ("delta", "cold")}
    for name, column in (("from", "time"), ("variance", "shorter")):
        row[name] = fitted[column][0] if len(time) else np.nan
    return row | fit.row("growth", "b")


@style.styled
def draw(tables: Tables) -> style.Figure:
    titles = ("Var(Q)/t over its first value", "growth over 2aJ²")
    figure, (left, right) = style.panels((960, 480), 1, 2, titles)
    found = tables["slow-pistons"]
    _draw_windows(left, tables["slow-pistons-windows"], found["delta"][0])
    style.level(right, 1)
    x = np.arange(len(found["ratio"]))
    style.error_points(right, x, *measured(found, "ratio"), style.BLUE)
    labels = [f"{delta:g}\n{cold:g}" for delta, cold in zip(found["delta"], found["cold"])]
    if np.isnan(found["ratio"]).all():
        style.inside(right, 0.5, 0.6, _NOT_MEASURED, ha="center")
    right.set_xticks(x, labels)
    right.minorticks_off()
    right.set(xlabel="δ, cold temperature", xlim=(-0.5, len(x) - 0.5))
    return figure


def _draw_windows(axes: Any, windows: Table, delta: float) -> None:
    cases = groups(rows(windows, delta=delta), "model", "cold") if windows else ()
    in_order = sorted(cases, key=lambda case: case[0])  # the jump process last
    for k, ((model, cold), part) in enumerate(in_order):
        shown = pick(part, _SHOWN)
        if not len(shown["time"]):
            continue
        label = f"cold {cold:g}" + (", jump process" if model == "markov" else "")
        first = shown["value"][0]
        variance = shown["standard_error"] ** 2  # changes are independent of `first`
        change_error = np.sqrt((variance - variance[0]).clip(0))
        value, error = shown["value"] / first, change_error / first
        dots: dict[str, Any] = {"label": label, "markersize": 4, "linestyle": "-", "linewidth": 0.8}
        style.error_points(axes, shown["time"], value, error, style.colour(k), **dots)
    axes.set(xlabel="t", xscale="log")
    if axes.lines:
        axes.legend()
    else:
        style.inside(axes, 0.5, 0.5, _NOT_MEASURED, ha="center")
