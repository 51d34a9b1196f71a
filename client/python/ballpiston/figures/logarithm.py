"""The billiard's integral time beyond its limit: which part of it is a logarithm of delta

The integral over the energy's autocorrelation in equilibrium, over a window, has two parts: pairs
that do not collide between the two times (idle), and pairs that do (met). Differences from the
limit delta -> 0 are shares of the limit's integral time.

a  the growth of both parts beyond a window of 8 mean free times, at the second delta; the line is
   the law of slow pistons
b  the differences at 8 mean free times over x, with x = (lambda + 2 delta)/tau_bp, by log(1/x)

The program `slow_pistons` measures them. Time on one core: quick 5 s, default 2 min, full 15 min.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ballpiston.client import Client
from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO
from ballpiston.figures.parts.programs import table_of
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, rows, stacked, table
from ballpiston.parameter_lists import Numbers, number_list

EFFORT: dict[str, dict[str, Any]] = {"quick": {"samples": 2048}, "full": {"samples": 131_072}}

PARTS = ("all", "idle", "met")
_INTEGRAL_TIME = 0.541387668432  # of the limit, in mean free times (docs/markov-limit.md)
_AT_REST = 1.25  # e^2/<e^2> of a piston at rest, with e = ep - 1/6
_FEWER_BELOW = 0.05  # orbits cost 1/delta^2; below this delta there are fewer of them
_LARGEST_FITTED = 0.15  # delta


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.14,0.1,0.07,0.05,0.025",
    samples: float = 16_384,
    seed: int = 0,
) -> Tables:
    """The parts of the integral at each delta by window, from `samples` orbits of 256 mean free times, and
    the fits. At delta below 0.05 there are orbits (delta/0.05)^2."""
    forms = client.analytic(rho, delta)
    found = []
    for d, width, tau in zip(
        number_list("delta", delta), forms["lambda"].tolist(), forms["tau_ball_piston"].tolist()
    ):
        count = int(samples * min(1.0, (d / _FEWER_BELOW) ** 2))
        flags = {"rho": rho, "delta": d, "orbits": count, "seed": seed}
        texts = [text for name, value in flags.items() for text in (f"--{name}", f"{value!r}")]
        windows = table_of("slow_pistons", "windows", *texts)
        facts = {"delta": d, "x": (width + 2 * d) / tau}
        facts["law"] = _AT_REST * (width + d) ** 2 / (width + 2 * d) / tau
        ones = np.ones(len(windows["window"]))
        found.append({name: fact * ones for name, fact in facts.items()} | windows)
    whole = stacked(found)
    return {
        "logarithm": whole,
        "logarithm-delta": logarithms_of_delta(whole),
        "logarithm-window": logarithms_of_window(whole),
    }


def excess(windows: Table, part: str) -> tuple[FloatArray, FloatArray]:
    """The difference of a part from its limit, a share of the limit's integral time, and its
    error."""
    limits = {"all": windows["limit_all"], "idle": windows["limit_idle"]}
    limits["met"] = limits["all"] - limits["idle"]
    value = windows[part] - limits[part]
    return value / _INTEGRAL_TIME, windows[f"{part}_error"] / _INTEGRAL_TIME


def logarithms_of_delta(whole: Table) -> Table:
    """Of each part at the first window, fits of the difference by a x + b x log(1/x), for delta up
    to 0.15; and by a x alone."""
    first = rows(whole, window=whole["window"].min())
    first = {name: column[first["delta"] <= _LARGEST_FITTED] for name, column in first.items()}
    x, found = first["x"], []
    for part in PARTS:
        both = fits.linear(np.column_stack([x, x * np.log(1 / x)]), *excess(first, part))
        plain = fits.linear(x[:, np.newaxis], *excess(first, part))
        row = {"part": part, "a": both.coefficients[0], "a_error": both.errors[0]}
        row |= {"b": both.coefficients[1], "b_error": both.errors[1]}
        row |= {"chi_squared": both.chi_squared, "freedom": both.freedom}
        row |= {"plain_a": plain.coefficients[0], "plain_a_error": plain.errors[0]}
        found.append(row | {"plain_chi_squared": plain.chi_squared, "plain_freedom": plain.freedom})
    return table(found)


def logarithms_of_window(whole: Table) -> Table:
    """Of both parts, the growth from the second window to the last one over the growth of idle pairs
    that slow pistons alone would give. The error is that of the growth from the first window."""
    lengths = np.unique(whole["window"])
    last, second = rows(whole, window=lengths[-1]), rows(whole, window=lengths[1])
    law = last["law"] * np.log(lengths[-1] / lengths[1])
    columns = {"delta": last["delta"], "law": last["law"] / _INTEGRAL_TIME}
    for part in ("idle", "met"):
        columns[part] = (last[f"later_{part}"] - second[f"later_{part}"]) / law
        columns[f"{part}_error"] = last[f"later_{part}_error"] / law
    return columns


@style.styled
def draw(tables: Tables) -> Figure:
    """Both panels."""
    figure = style.picture(960, 480)
    left, right = figure.subplots(1, 2)
    whole = tables["logarithm"]
    _draw_growth(left, rows(whole, delta=np.unique(whole["delta"])[-2]))
    first = rows(whole, window=whole["window"].min())
    for k, part in enumerate(PARTS):
        value, error = excess(first, part)
        shown = np.log(1 / first["x"]), value / first["x"], error / first["x"]
        style.error_points(right, *shown, style.colour(k), part)
    style.level(right, 0)
    right.set(xlabel="log(1/x)", ylabel="difference/x")
    right.legend()
    return figure


def _draw_growth(axes: Any, windows: Table) -> None:
    logarithm = np.log(windows["window"] / windows["window"][0])
    law = windows["law"] * logarithm / _INTEGRAL_TIME
    axes.plot(windows["window"], law, color=style.BLACK, label="law of slow pistons")
    for k, part in enumerate(PARTS[1:], 1):
        value, error = (windows[f"later_{part}{end}"] / _INTEGRAL_TIME for end in ("", "_error"))
        style.error_points(axes, windows["window"], value, error, style.colour(k), part)
    axes.set_xscale("log", base=2)
    delta = windows["delta"][0]
    axes.set(xlabel="window, mean free times", ylabel=f"growth beyond 8, δ = {delta:g}")
    axes.legend()
