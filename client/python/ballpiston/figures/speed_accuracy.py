"""Speed against accuracy of every method, measured on this machine

Work-precision diagrams of every method, which the program method_comparison measures. It needs no
server. No other program should be busy on the machine.

a, b  relative error of the conditional mean free time, against time and against wall hits
c     error of the ingoing law of first hits, as a Kullback-Leibler divergence
d     wall hits until an orbit leaves the high-precision orbit, against the time of a hit
e     relative error of the energy's relaxation time, by the billiard and by the limit delta -> 0,
      for the largest deltas (at most two) that resolve the bias of the limit
f     relative error of the heat current of a gas of one cell between two reservoirs

A line is the expected error, the root of sigma^2 + bias^2. sigma is the statistical error of a run.
bias is the deviation of the method's longest run if it exceeds three statistical errors, else 0. An
error bar is one standard error of the error. Single precision and the reference with 64 bits are
drawn only in d: in the other panels their lines would almost coincide with the lines of double
precision. Panels without data are left out.
Time on one core: quick 3 s, default 1 min, full 20 min.
"""

import os
from typing import Any

import matplotlib
import numpy as np
from matplotlib.ticker import EngFormatter

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO
from ballpiston.figures.parts.programs import table_of
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, distinct, groups, pick, rows

EFFORT = {"quick": {"seconds": 0.03}, "full": {"seconds": 10.0}}

# Method: title and colour. The first five are in panels a, b, c and f, all of them in d. The colour
# of fixed steps depends on the step.
_METHODS = {
    "fixed-step": ("Δt", ""),
    "billiard-reference": ("reference", style.GREEN),
    "billiard-reference-quadruple": ("113 bits", "#777777"),
    "billiard": ("vector lanes", style.BLUE),
    "markov": ("jump process", "#882255"),
    "billiard-single": ("lanes, single", "#56b4e9"),
    "billiard-reference-single": ("reference, single", "#b8d432"),
    "billiard-reference-long-double": ("64 bits", style.PINK),
}
_OF_ERRORS = list(_METHODS)[:5]
_STEPS = matplotlib.colormaps["Oranges"]
_DELTA_COLOURS = ("#440154", "#2a788e")
_FEWEST_SAMPLES = 64  # errors from fewer samples are too uncertain and are not drawn
_FEWEST_ORBITS = 256  # the same for e
_RESOLVED = 2.0  # a bias of the limit is at least this number of statistical errors
_SMALL = {"fontsize": 9}


def measure(
    *,
    rho: float = RHO,
    delta: float = 0.1,
    epsilon: float = 0.125,
    relaxation_delta: str = "",
    seconds: float = 0.5,
    seed: int = 0,
) -> Tables:
    """delta is that of panels a to d, epsilon the piston's energy in panels a to c. Panel f has a
    separate delta: 0.2, or the gas's bound if that is smaller. Panel e chooses among
    `relaxation_delta`, at most 8; if it is empty, among 0.2, 0.1, 0.05 and 0.025, as far as rho
    permits them. `seconds` are those of each method's largest run, 0.01 to 60."""
    values: dict[str, Any] = {"rho": rho, "delta": delta, "epsilon": epsilon, "seed": seed}
    values |= {"seconds": seconds, "relaxation_delta": relaxation_delta}
    styles = {"none": "none", "json": "none", "bar": "bar"}
    if shown := styles.get(os.environ.get("BALLPISTON_PROGRESS", "")):
        values["progress"] = shown
    return {"speed-accuracy": table_of("method_comparison", **values)}


def curves_of(data: Table, quantity: str, fewest_samples: int = 1) -> list[style.Series]:
    """The runs of enough samples of each method at each time step (0 if it has none), the longest
    run last. Larger fixed steps have a lighter colour."""
    data = rows(data, quantity=quantity)
    data = pick(data, data["samples"] >= fewest_samples)
    found = []
    for (method, step), runs in groups(data, "method", "time_step"):
        title, colour = _METHODS.get(method, ("", ""))
        if step > 0:
            title, colour = f"Δt = {style.power_text(step)}", _STEPS(0.25 - 0.18 * np.log10(step))
        if title:
            found.append((runs, colour, title))
    return found


def resolved_bias(runs: Table) -> tuple[float, float]:
    """The bias of the longest run, if it is resolved, else 0, and its standard error."""
    last = pick(runs, -1)
    return float(last["value"] if last["bias_resolved"] == 1 else 0.0), last["statistical_error"]


def expected_error(runs: Table, bias: float, error_of_bias: float) -> tuple[FloatArray, FloatArray]:
    """sqrt(sigma^2 + bias^2) of each run, and its standard error if the scatter is normal."""
    error = np.hypot(runs["own_error"], bias)
    chance = runs["own_error"] ** 2 / np.sqrt(2 * runs["samples"])
    return error, np.hypot(chance, bias * error_of_bias) / error


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["speed-accuracy"]
    has_gas = "heat-current" in data["quantity"]
    has_limit = "relaxation-time" in data["quantity"]
    lines = 3 if has_gas or has_limit else 2
    titles = (
        "mean free time, against time",
        "mean free time, against wall hits",
        "law of the ingoing angle",
        "single orbits",
        "relaxation time of the energy",
        "heat current of a gas of one cell",
    )
    figure, panels = style.panels((960, 400 * lines + 120), lines, 2, titles)
    _draw_errors(panels[0, 0], data, "mean-free-time", "work_seconds")
    _draw_errors(panels[0, 1], data, "mean-free-time", "wall_hits")
    _draw_errors(panels[1, 0], data, "ingoing-law", "wall_hits")
    panels[1, 0].set_ylabel("Kullback-Leibler divergence")
    _note_closed_form(panels[0, 0], rows(data, quantity="mean-free-time", method="closed-form"))
    _draw_orbits(panels[1, 1], curves_of(data, "trajectory"))
    if has_limit:
        _draw_relaxation(panels[2, 0], data)
    if has_gas:
        _draw_errors(panels[2, 1], data, "heat-current", "work_seconds")
        _note_lost_balls(panels[2, 1], data)
    for axes in panels.flat:
        if not axes.has_data():
            axes.remove()
    quantities = distinct(data["quantity"])
    colours = {title: of for q in quantities for _, of, title in curves_of(data, q)}
    handles = [style.point_handle(title, colours[title]) for title in sorted(colours)]
    style.top_legend(figure, handles, columns=6)
    figure.supxlabel(_parameters(data, has_gas), x=0.01, ha="left", fontsize=10)
    return figure


def _parameters(data: Table, has_gas: bool) -> str:
    pair = rows(data, quantity="mean-free-time")
    rho, delta, epsilon = (pair[name][0] for name in ("rho", "delta", "epsilon"))
    text = f"a to c: ρ = {rho:.6g}, δ = {delta:g}, ε = {epsilon:g}. d: this ρ."
    if has_gas:
        gas_delta = rows(data, quantity="heat-current")["delta"][0]
        text += f" f: this ρ, δ = {gas_delta:.6g}, walls at T = 1.5 and 0.5."
    return text + (
        "\nLines: statistical error and bias. 113 bits: the reference, more precise. "
        "Not drawn in a to c: single, 64 bits; as double."
    )


def _draw_errors(axes: Any, data: Table, quantity: str, by: str) -> None:
    for runs, colour, _ in curves_of(data, quantity, _FEWEST_SAMPLES):
        if runs["method"][0] in _OF_ERRORS:
            errors = expected_error(runs, *resolved_bias(runs))
            style.error_points(axes, runs[by], *errors, colour, fmt="o-", markersize=3)
    axes.set(xscale="log", yscale="log", ylabel="relative error")
    axes.set_xlabel("wall hits" if by == "wall_hits" else "time / s")


def _note_closed_form(axes: Any, closed: Table) -> None:
    if len(closed["value"]):
        time = EngFormatter("s", places=0)(closed["work_seconds"][-1])
        error = style.power_text(closed["value"][-1])
        style.inside(axes, 0.03, 0.05, f"closed form: {time}, error ≤ {error}", **_SMALL)


def _note_lost_balls(axes: Any, data: Table) -> None:
    """The time steps that have no run of enough samples."""
    curves = curves_of(data, "heat-current", _FEWEST_SAMPLES)
    shown = {runs["time_step"][0] for runs, _, _ in curves}
    steps = distinct(rows(data, method="fixed-step")["time_step"])
    lost = ", ".join(style.power_text(step) for step in steps if step not in shown)
    if lost:
        style.inside(axes, 0.03, 0.05, f"balls lost, or too slow: Δt = {lost}", **_SMALL)


def _draw_orbits(axes: Any, curves: list[style.Series]) -> None:
    """Only the longest runs: the cost of a hit and the horizon do not depend on the number of
    orbits."""
    if not curves:
        return
    style.level(axes, 0, color=style.GREY)
    for runs, colour, _ in curves:
        run = pick(runs, -1)
        cost = 1e9 * run["work_seconds"] / run["wall_hits"]
        style.error_points(axes, cost, run["value"], run["own_error"], colour, markersize=6)
    axes.set(xscale="log", xlabel="time of a wall hit / ns")
    axes.set_ylabel("wall hits until the orbit is wrong")


def floors_of_limit(runs: Table) -> Table:
    """The error of the relaxation time that more work by the limit cannot reduce, at each delta,
    the largest delta first, and its standard error. It is the limit's bias, or an upper bound of
    it: the spectrum's deviation, which may be chance, plus _RESOLVED statistical errors."""
    spectra = rows(runs, method="spectrum")
    spectra = pick(spectra, np.unique(-spectra["delta"], return_index=True)[1])
    error = spectra["statistical_error"]
    is_bias = spectra["value"] >= _RESOLVED * error
    value = spectra["value"] + np.where(is_bias, 0.0, _RESOLVED * error)
    return {"delta": spectra["delta"], "value": value, "error": error, "is_bias": is_bias}


def _draw_relaxation(axes: Any, data: Table) -> None:
    runs = rows(data, quantity="relaxation-time")
    floors = floors_of_limit(runs)
    chosen = pick(floors, floors["is_bias"] if floors["is_bias"].any() else slice(1))
    columns = (chosen[name] for name in ("delta", "value", "error"))
    for delta, bias, error_of_bias, colour in zip(*columns, _DELTA_COLOURS):
        axes.axhline(bias, color=colour, dashes=(3, 4), linewidth=1.2)
        spectrum = rows(runs, delta=delta, method="spectrum")["work_seconds"]
        label = f"spectrum, δ = {delta:g}"
        axes.plot(spectrum, np.full(len(spectrum), bias), "D", color=colour, label=label)
        for method, name, line in (("markov", "limit", (0, (8, 4))), ("billiard", "billiard", "-")):
            part = rows(runs, delta=delta, method=method)
            part = pick(part, part["samples"] >= _FEWEST_ORBITS)
            biased = (bias, error_of_bias) if method == "markov" else (0.0, 0.0)
            errors = expected_error(part, *biased)
            label = f"{name}, δ = {delta:g}"
            dots: dict[str, Any] = {"markersize": 3, "linestyle": line}
            style.error_points(axes, part["work_seconds"], *errors, colour, label, **dots)
    axes.set(xscale="log", yscale="log", xlabel="time / s", ylabel="relative error")
    axes.margins(y=0.4)
    axes.legend(loc="upper left", ncol=2, handlelength=2.5, **_SMALL)
    bounds = ", ".join(
        f"δ = {delta:g}: ≤ {100 * value:.2g} %"
        for delta, value, is_bias in zip(floors["delta"], floors["value"], floors["is_bias"])
        if not is_bias
    )
    if bounds:
        style.inside(axes, 0.03, 0.04, f"limit unresolved:\n{bounds}", **_SMALL)
