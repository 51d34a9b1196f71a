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

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO
from ballpiston.figures.parts.programs import output_of
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, distinct, rows, table

EFFORT = {"quick": {"seconds": 0.03}, "full": {"seconds": 10.0}}

# Method: title and colour. The first five are in panels a, b, c and f, all of them in d.
_METHODS = {
    "fixed-step": ("Δt", style.ORANGE),
    "billiard-reference": ("reference", style.GREEN),
    "billiard-reference-quadruple": ("113 bits", "#777777"),
    "billiard": ("vector lanes", style.BLUE),
    "markov": ("jump process", "#882255"),
    "billiard-single": ("lanes, single", "#56b4e9"),
    "billiard-reference-single": ("reference, single", "#e69f00"),
    "billiard-reference-long-double": ("64 bits", style.PINK),
}
_OF_ERRORS = list(_METHODS)[:5]
_DELTA_COLOURS = ("#440154", "#2a788e")
_FEWEST_SAMPLES = 64  # errors from fewer samples are too uncertain and are not drawn
_FEWEST_ORBITS = 256  # the same for e
_RESOLVED = 2.0  # a bias of the limit is at least this number of statistical errors
_LABEL_AT = 1.5  # a label is right of the end of its line, by this factor
_ROOM = 150.0  # space for the labels, right of the longest run, as a factor
_LINE_OF_TEXT = 0.062  # height of a line of text, as a share of an axis
_SMALL = {"fontsize": 9}
_TEXTS = ("method", "quantity")


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
    values = {"rho": rho, "delta": delta, "epsilon": epsilon, "seconds": seconds, "seed": seed}
    arguments = [f"--{name}={value}" for name, value in values.items()]
    styles = {"none": ["--progress=none"], "json": ["--progress=none"], "bar": ["--progress=bar"]}
    arguments += styles.get(os.environ.get("BALLPISTON_PROGRESS", ""), [])
    arguments.append(f"--relaxation-delta={relaxation_delta}")
    return {"speed-accuracy": measurements(output_of("method_comparison", *arguments))}


def measurements(text: str) -> Table:
    """The program's CSV; a value that does not exist is NaN."""
    lines = csv.DictReader(text.splitlines())
    return table(
        {n: cell if n in _TEXTS else float(cell or "nan") for n, cell in line.items()}
        for line in lines
    )


@dataclass(frozen=True)
class Curve:
    """The runs of a method at one time step (0 if it has none), the longest run last."""

    method: str
    time_step: float
    runs: Table

    @property
    def colour(self) -> str:
        return _METHODS[self.method][1]

    @property
    def title(self) -> str:
        if self.time_step > 0:
            return f"Δt = {style.power_text(self.time_step)}"
        return _METHODS[self.method][0]

    @property
    def bias(self) -> float:
        """Of the longest run, if it is resolved."""
        return float(self.runs["value"][-1] if self.runs["bias_resolved"][-1] == 1 else 0.0)

    @property
    def expected_error(self) -> FloatArray:
        """sqrt(sigma^2 + bias^2) of each run."""
        error: FloatArray = np.hypot(self.runs["own_error"], self.bias)
        return error

    @property
    def error_of_error(self) -> FloatArray:
        """One standard error of `expected_error` if the scatter is normal."""
        chance = self.runs["own_error"] ** 2 / np.sqrt(2 * self.runs["samples"])
        of_bias = self.bias * self.runs["statistical_error"][-1]
        error: FloatArray = np.hypot(chance, of_bias) / self.expected_error
        return error


def curves_of(data: Table, quantity: str, fewest_samples: int = 1) -> list[Curve]:
    """The methods that have runs of enough samples."""
    data = rows(data, quantity=quantity)
    data = {name: column[data["samples"] >= fewest_samples] for name, column in data.items()}
    found = distinct(zip(data["method"], data["time_step"]))
    return [Curve(m, s, rows(data, method=m, time_step=s)) for m, s in found if m in _METHODS]


def spread(wanted: list[float], gap: float) -> list[float]:
    """Heights of labels, at most the wanted ones, each at least the factor `gap` below the next
    label above it."""
    heights = [0.0] * len(wanted)
    above = np.inf
    for k in sorted(range(len(wanted)), key=lambda k: -wanted[k]):
        heights[k] = above = min(wanted[k], above / gap)
    return heights


@style.styled
def draw(tables: Tables) -> Figure:
    """The panels that have data, and a line with the parameters."""
    data = tables["speed-accuracy"]
    has_gas = "heat-current" in data["quantity"]
    has_limit = "relaxation-time" in data["quantity"]
    lines = 3 if has_gas or has_limit else 2
    figure = style.picture(960, 400 * lines + 60)
    figure.get_layout_engine().set(rect=(0, 0.04, 1, 0.96))
    panels = figure.subplots(lines, 2)
    _draw_errors(panels[0, 0], data, "mean-free-time", "work_seconds")
    _draw_errors(panels[0, 1], data, "mean-free-time", "wall_hits")
    _draw_errors(panels[1, 0], data, "ingoing-law", "wall_hits")
    style.title(panels[0, 0], "a", "mean free time, against time")
    style.title(panels[0, 1], "b", "mean free time, against wall hits")
    style.title(panels[1, 0], "c", "law of the ingoing angle")
    panels[1, 0].set_ylabel("Kullback-Leibler divergence")
    _note_closed_form(panels[0, 0], rows(data, quantity="mean-free-time", method="closed-form"))
    _draw_orbits(panels[1, 1], curves_of(data, "trajectory"))
    if has_limit:
        _draw_relaxation(panels[2, 0], data)
    if has_gas:
        _draw_errors(panels[2, 1], data, "heat-current", "work_seconds")
        style.title(panels[2, 1], "f", "heat current of a gas of one cell")
        _note_lost_balls(panels[2, 1], data)
    for axes in panels.flat:
        if not axes.has_data():
            axes.remove()
    figure.text(0.01, 0.004, _parameters(data, has_gas), fontsize=10, va="bottom")
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
    """Against time each line has a name. Against hits, all methods without a bias have the same
    line. Its name is at the end of the line of the vector lanes, or of another method if there are
    no lanes."""
    by_hits = by == "wall_hits"
    curves = [c for c in curves_of(data, quantity, _FEWEST_SAMPLES) if c.method in _OF_ERRORS]
    if not curves:
        return
    for curve in curves:
        errors = curve.expected_error, curve.error_of_error
        style.error_points(axes, curve.runs[by], *errors, curve.colour, fmt="o-", markersize=3)
    unbiased = [c for c in curves if by_hits and c.bias == 0]
    common = next((c for c in unbiased if c.method == "billiard"), next(iter(unbiased), None))
    named = [c for c in curves if c is common or c not in unbiased]
    every = np.concatenate([c.runs["own_error"] for c in curves])
    work = np.concatenate([c.runs[by] for c in curves])
    low = 0.4 * every[every > 0].min()
    high = 3 * max(float(c.expected_error.max()) for c in curves)
    heights = spread(
        [float(c.expected_error[-1]) for c in named], (high / low) ** _LINE_OF_TEXT
    )
    for curve, height in zip(named, heights):
        end = float(curve.runs[by][-1]) if by_hits else work.max()
        text = "all others" if curve is common else curve.title
        axes.text(_LABEL_AT * end, height, text, color=curve.colour, va="center", **_SMALL)
    axes.set(xscale="log", yscale="log", ylim=(low, high), ylabel="relative error")
    axes.set_xlim(0.5 * work[work > 0].min(), _ROOM * work.max())
    axes.set_xlabel("wall hits" if by_hits else "time / s")


def _note_closed_form(axes: Any, closed: Table) -> None:
    if len(closed["value"]):
        time, error = duration(closed["work_seconds"][-1]), style.power_text(closed["value"][-1])
        style.inside(axes, 0.03, 0.05, f"closed form: {time}, error ≤ {error}", **_SMALL)


def _note_lost_balls(axes: Any, data: Table) -> None:
    """The time steps that have no run of enough samples."""
    shown = {c.time_step for c in curves_of(data, "heat-current", _FEWEST_SAMPLES)}
    steps = distinct(rows(data, method="fixed-step")["time_step"])
    lost = ", ".join(style.power_text(step) for step in steps if step not in shown)
    if lost:
        style.inside(axes, 0.03, 0.05, f"balls lost, or too slow: Δt = {lost}", **_SMALL)


def duration(seconds: float) -> str:
    """Such as 17 ms."""
    for unit, name in ((1e-9, "ns"), (1e-6, "µs"), (1e-3, "ms"), (1.0, "s")):
        count = seconds / unit
        if count < 999.5 or name == "s":
            return f"{count:.1f} {name}" if count < 9.95 else f"{count:.0f} {name}"
    raise AssertionError("unreachable")


def _draw_orbits(axes: Any, curves: list[Curve]) -> None:
    """Only the longest runs: the cost of a hit and the horizon do not depend on the number of
    orbits."""
    if not curves:
        return
    last = [{name: column[-1] for name, column in curve.runs.items()} for curve in curves]
    highest = max(run["value"] for run in last)
    costs = [1e9 * run["work_seconds"] / run["wall_hits"] for run in last]
    style.level(axes, 0, color=style.GREY)
    is_first_step = True
    for curve, run, cost in zip(curves, last, costs):
        style.error_points(axes, cost, run["value"], run["own_error"], curve.colour, markersize=6)
        if curve.time_step > 0:
            text = curve.title if is_first_step else style.power_text(curve.time_step)
            is_first_step = False
            place = {"rotation": 90, "va": "top", "ha": "center"}
            axes.text(cost, -0.05 * highest, text, color=curve.colour, **place, **_SMALL)
        else:
            height = run["value"] + 0.06 * highest
            axes.text(cost, height, curve.title, color=curve.colour, ha="center", **_SMALL)
    axes.set(xscale="log", xlim=(0.2 * min(costs), 5 * max(costs)))
    axes.set_xlabel("time of a wall hit / ns")
    axes.set(ylim=(-0.5 * highest, 1.2 * highest), ylabel="wall hits until the orbit is wrong")
    style.title(axes, "d", "single orbits")


def floors_of_limit(runs: Table) -> Table:
    """The error of the relaxation time that more work by the limit cannot reduce, at each delta,
    the largest delta first. It is the limit's bias, or an upper bound of it: the spectrum's
    deviation, which may be chance, plus _RESOLVED statistical errors."""
    spectra = rows(runs, method="spectrum")
    first = np.unique(-spectra["delta"], return_index=True)[1]
    spectra = {name: column[first] for name, column in spectra.items()}
    chance = _RESOLVED * spectra["statistical_error"]
    is_bias = spectra["value"] >= chance
    value = spectra["value"] + np.where(is_bias, 0.0, chance)
    return {"delta": spectra["delta"], "value": value, "is_bias": is_bias}


def _draw_relaxation(axes: Any, data: Table) -> None:
    runs = rows(data, quantity="relaxation-time")
    floors = floors_of_limit(runs)
    is_bias = floors["is_bias"]
    chosen = floors["delta"][is_bias][: len(_DELTA_COLOURS)]
    if not len(chosen):
        chosen = floors["delta"][:1]
    enough = runs["samples"] >= _FEWEST_ORBITS
    names, wanted, colours, chance = [], [], [], []
    for delta, colour in zip(chosen, _DELTA_COLOURS):
        bias = float(rows(floors, delta=delta)["value"][0])
        near = {name: c[enough & (runs["delta"] == delta)] for name, c in runs.items()}
        limit, billiard = (rows(near, method=method) for method in ("markov", "billiard"))
        dashed = {"color": colour, "markersize": 3, "linestyle": (0, (8, 4))}
        axes.plot(limit["work_seconds"], np.hypot(limit["own_error"], bias), marker="o", **dashed)
        axes.plot(billiard["work_seconds"], billiard["own_error"], "o-", color=colour, markersize=3)
        axes.axhline(bias, color=colour, dashes=(3, 4), linewidth=1.2)
        spectrum = rows(runs, delta=delta, method="spectrum")["work_seconds"]
        axes.plot(spectrum, np.full(len(spectrum), bias), "D", color=colour, markersize=6)
        for work in spectrum:
            axes.text(work, 1.12 * bias, "spectrum", color=colour, **_SMALL)
        names += [f"billiard, δ = {delta:g}", f"limit, δ = {delta:g}"]
        wanted += [float(billiard["own_error"][-1]) if len(billiard["own_error"]) else bias, bias]
        colours += [colour, colour]
        chance += billiard["own_error"].tolist()
    _finish_relaxation(axes, runs, chance + wanted)
    low, high = axes.get_ylim()
    end = _LABEL_AT * runs["work_seconds"][enough].max()
    for name, y, colour in zip(names, spread(wanted, (high / low) ** _LINE_OF_TEXT), colours):
        axes.text(end, y, name, color=colour, va="bottom", **_SMALL)
    bounds = ", ".join(
        f"δ = {delta:g}: ≤ {100 * value:.2g} %"
        for delta, value in zip(floors["delta"][~is_bias], floors["value"][~is_bias])
    )
    if bounds:
        style.inside(axes, 0.03, 0.04, f"limit unresolved:\n{bounds}", **_SMALL)


def _finish_relaxation(axes: Any, runs: Table, errors: list[float]) -> None:
    work = runs["work_seconds"][runs["work_seconds"] > 0]
    axes.set(xscale="log", yscale="log", ylim=(0.3 * min(errors), 3 * max(errors)))
    axes.set(xlim=(0.3 * work.min(), 30 * _ROOM * work.max()), xlabel="time / s")
    axes.set_ylabel("relative error")
    style.title(axes, "e", "relaxation time of the energy")
