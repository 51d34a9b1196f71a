"""One orbit of ball and piston: the path in the cell, positions and energies against time

Above left, the ball's path in its cell, coloured by its energy; the piston reaches the shaded part.
Above right, the energies, which change only where ball and piston collide (circles). Below, the
positions of both along the piston's axis.
"""

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon

from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import Table, Tables, pick, rows, table

_SHOWN_TIME = 25.0  # of the path and the positions; longer curves would be too dense
_FIELDS = ("x", "y", "energy")
_MEETING = {"color": style.BLACK, "markersize": 6, "fillstyle": "none", "linestyle": ""}


def measure(
    client: Client, *, rho: float = RHO, delta: float = 0.3, seed: int = 0, events: int = 200
) -> Tables:
    """The start and all events of each body, and one row with the geometry. delta is large, so that
    ball and piston collide often."""
    start, *orbit = client.trace(rho=rho, delta=delta, seed=seed, events=events)
    tables = {}
    for body in ("ball", "piston"):
        first = start[f"{body}s"][0] | {"time": 0.0, "event": "start"}
        later = [e | {name: e[f"{body}_{name}"] for name in _FIELDS} for e in orbit if body in e]
        tables[f"orbit-{body}"] = table([first, *later], ("time", "event", *_FIELDS))
    geometry = table([{name: start[name] for name in ("rho", "delta", "lambda", "tip")}])
    return tables | {"orbit-geometry": geometry}


@style.styled
def draw(tables: Tables) -> style.Figure:
    at = pick(tables["orbit-geometry"], 0)
    bodies = {"ball": tables["orbit-ball"], "piston": tables["orbit-piston"]}
    end = min(body["time"][-1] for body in bodies.values())
    figure = style.picture(960, 900)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1))
    _draw_path(figure, style.bare_axes(figure, grid[0, 0]), bodies["ball"], at)
    _draw_energies(figure.add_subplot(grid[0, 1]), bodies, end)
    _draw_positions(figure.add_subplot(grid[1, :]), bodies, at, min(end, _SHOWN_TIME))
    return figure


def _draw_path(figure: style.Figure, axes: Any, ball: Table, at: dict[str, float]) -> None:
    tip, low = at["tip"], at["tip"] - at["delta"]
    outline = cell_outline.outline(at["rho"])
    axes.add_patch(Polygon(outline, fill=False, edgecolor=style.BLACK, linewidth=2, zorder=3))
    x = np.linspace(low, tip, 100)
    half = cell_outline.half_height(at["rho"], tip - x)
    axes.fill_between(x, -half, half, color=style.REACH)
    scale = style.energy_bar(
        figure, axes, 0.5, "ball's energy", orientation="horizontal", shrink=0.6, pad=0.01
    )
    early = pick(ball, ball["time"] <= _SHOWN_TIME)
    points = np.column_stack([early["x"], early["y"]])
    path = LineCollection(np.stack([points[:-1], points[1:]], axis=1), linewidths=1.2)
    path.set_color(scale.to_rgba(early["energy"][:-1]))
    axes.add_collection(path)
    met = rows(early, event="ball_piston")
    axes.plot(met["x"], met["y"], "o", **_MEETING)
    axes.set(xlim=(-1.03 * tip, 1.03 * tip), ylim=(-1.03 * tip, 1.03 * tip))


def _draw_energies(axes: Any, bodies: Tables, end: float) -> None:
    for (name, body), colour in zip(bodies.items(), (style.ORANGE, style.BLUE)):
        axes.step(body["time"], body["energy"], where="post", color=colour, label=name)
        met = rows(body, event="ball_piston")
        axes.plot(met["time"], met["energy"], "o", color=colour, markersize=3)
    axes.set(xlim=(0, end), ylim=(0, 0.5), xlabel="time", ylabel="energy")
    _legend_above(axes)


def _draw_positions(axes: Any, bodies: Tables, at: dict[str, float], end: float) -> None:
    labels = ("ball, q₁", "piston, q₃")
    axes.axhspan(at["tip"] - at["delta"], at["tip"], color=style.REACH)
    for body, label, colour in zip(bodies.values(), labels, (style.ORANGE, style.BLUE)):
        axes.plot(body["time"], body["x"], color=colour, label=label)
    met = rows(bodies["ball"], event="ball_piston")
    axes.plot(met["time"], met["x"], "o", **_MEETING)
    top = 1 - at["tip"] + at["delta"]
    axes.set(xlim=(0, end), ylim=(-at["tip"], top), xlabel="time", ylabel="position")
    _legend_above(axes)


def _legend_above(axes: Any) -> None:
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=2, frameon=False, borderpad=0)
