"""The billiard's integral time beyond its limit: which part of it is a logarithm of delta

The integral over the energy's autocorrelation in equilibrium, over a window, has two parts: pairs
that do not collide between the two times (idle), and pairs that do (met). Differences from the
limit delta -> 0 are shares of the limit's integral time.

a  the growth of both parts beyond a window of 8 mean free times, at the first delta; the line is
   the law of slow pistons
b  the differences at 8 mean free times over x = (lambda + 2 delta)/tau_bp, against log(1/x); lines
   are fits

A hollow point has too few events for an error.
The program `slow_pistons` measures them. Time on one core: quick 5 s, default 2 min, full 15 min.
"""

import numpy as np

from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, number_list
from ballpiston.figures.parts.programs import table_of
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, groups
from ballpiston.figures.parts.tables import measured, rows, stacked, table

EFFORT = {"quick": {"samples": 2048}, "full": {"samples": 131_072}}

PARTS = ("all", "idle", "met")
_INTEGRAL_TIME = 0.541387668432  # of the limit, in mean free times (docs/research/markov-limit.md)
_AT_REST = 1.25  # e^2/<e^2> of a piston at rest, with e = ep - 1/6
_ASIDE = 0.03  # shift of points, so that all are visible
_SHOWN = (-4, 6)  # of panel b, at least
_LARGEST_SEED = 10**15  # of slow_pistons
_FEWER_BELOW = 0.05  # orbits cost 1/delta^2; below this delta there are fewer of them


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.14,0.1,0.07,0.05,0.025",
    samples: float = 16_384,
    seed: int = 0,
) -> Tables:
    """The fits, and the parts of the integral at each delta by window, from `samples` orbits of 256
    mean free times. Below delta = 0.05 the number of orbits is smaller by the factor
    (delta/0.05)^2, but at least 2."""
    forms = client.analytic(rho, delta)
    found = []
    widths, times = forms["lambda"].tolist(), forms["tau_ball_piston"].tolist()
    if seed + len(widths) - 1 > _LARGEST_SEED:
        raise ValueError(f"seed is {seed}; permitted: at most {_LARGEST_SEED - len(widths) + 1}")
    for k, (d, width, tau) in enumerate(zip(number_list("delta", delta), widths, times)):
        count = max(2, int(samples * min(1.0, (d / _FEWER_BELOW) ** 2)))
        pair = {"rho": rho, "delta": d, "seed": seed + k}  # with one seed the starts are the same
        windows = table_of("slow_pistons", "windows", **pair, orbits=count)
        facts = {"delta": d, "x": (width + 2 * d) / tau}
        facts["law"] = _AT_REST * (width + d) ** 2 / (width + 2 * d) / tau
        found.append(facts | windows)
    whole = stacked(found)
    return {
        "logarithm": whole,
        "logarithm-delta": logarithms_of_delta(whole),
        "logarithm-window": logarithms_of_window(whole),
    }


def excess(windows: Table, part: str) -> tuple[FloatArray, FloatArray]:
    """The difference of a part from its limit, a share of the limit's integral time, and its
    error."""
    return measured(windows, part, _limit(windows, part), _INTEGRAL_TIME)


def _limit(windows: Table, part: str) -> FloatArray:
    met: FloatArray = windows["limit_all"] - windows["limit_idle"]
    return met if part == "met" else windows[f"limit_{part}"]


def logarithms_of_delta(whole: Table) -> Table:
    """Of each part at the first window, fits of the difference by a x + b x log(1/x), and by a x
    alone."""
    first = rows(whole, window=whole["window"].min())
    x, found = first["x"], []
    for part in PARTS:
        both = fits.linear(np.column_stack([x, x * np.log(1 / x)]), *excess(first, part))
        plain = fits.linear(x[:, np.newaxis], *excess(first, part))
        alone = {f"plain_{name}": number for name, number in plain.row("a").items()}
        found.append({"part": part} | both.row("a", "b") | alone)
    return table(found)


def logarithms_of_window(whole: Table) -> Table:
    """Of both parts and at each delta from 0.05 on, a fit of the growth from W to 2 W by
    ratio law ln 2 + c/(2 W). `law` is that of slow pistons; slow balls have a term 1/W."""
    found = []
    for (delta,), windows in groups(whole, "delta"):
        if delta < _FEWER_BELOW:
            continue  # too few orbits have a piston that is slow enough
        row = {"delta": delta, "law": windows["law"][0] / _INTEGRAL_TIME}
        for part in PARTS[1:]:
            fit = _growth(windows, part)
            row |= {part: fit.coefficients[0], f"{part}_error": fit.errors[0]}
            row |= {f"{part}_chi_squared": fit.chi_squared, f"{part}_freedom": fit.freedom}
        found.append(row)
    return table(found)


def _growth(windows: Table, part: str) -> fits.Fit:
    """The errors are those of increments that are independent of each other. Increments without
    enough events have none, and are left out."""
    value = np.diff(windows[f"later_{part}"] - _limit(windows, part))
    error = np.sqrt(np.maximum(np.diff(windows[f"later_{part}_error"] ** 2), 0))
    known = error > 0
    shorter = windows["window"][:-1]
    terms = np.column_stack([windows["law"][:-1] * np.log(2), 1 / (2 * shorter)])
    return fits.linear(terms[known], value[known], error[known])


@style.styled
def draw(tables: Tables) -> style.Figure:
    whole = tables["logarithm"]
    titles = f"growth beyond 8, δ = {whole['delta'][0]:g}", "difference up to 8, over x"
    figure, (left, right) = style.panels((960, 480), 1, 2, titles)
    _draw_growth(left, rows(whole, delta=whole["delta"][0]))
    first = rows(whole, window=whole["window"].min())
    for k, part in enumerate(PARTS):
        logarithm = np.log(1 / first["x"])
        fit = rows(tables["logarithm-delta"], part=part)
        line = np.linspace(logarithm.min(), logarithm.max(), 2)
        right.plot(line, fit["a"] + fit["b"] * line, color=style.colour(k))
        aside = _ASIDE * (k - 1) if len(logarithm) > 1 else 0
        value, error = (column / first["x"] for column in excess(first, part))
        style.error_points(right, logarithm + aside, value, error, style.colour(k), part)
    style.level(right, 0)
    style.widen(right, *_SHOWN)
    right.set(xlabel="log(1/x)")
    right.legend(loc="lower left")
    return figure


def _draw_growth(axes: style.Axes, windows: Table) -> None:
    logarithm = np.log(windows["window"] / windows["window"][0])
    law = windows["law"] * logarithm / _INTEGRAL_TIME
    axes.plot(windows["window"], law, color=style.BLACK, label="law of slow pistons")
    for k, part in enumerate(PARTS[1:], 1):
        values = measured(windows, f"later_{part}", unit=_INTEGRAL_TIME)
        style.error_points(axes, windows["window"], *values, style.colour(k), part)
    style.level(axes, 0)
    axes.set_xscale("log")
    style.plain_log_ticks(axes.xaxis, windows["window"].tolist())
    axes.set(xlabel="window, mean free times")
    axes.legend()
