"""The ball-piston pair and the parameters of its cell (the paper's figure of the minimal model)

The ball moves in the cell between four discs of radius rho at the corners of the unit square. The
piston, a vertical segment of height eta, moves in the piston cell, which is lambda + 2 delta long.
lambda, with tan(theta) = lambda, is the length of the overlap of two opposite discs. Arrows are
proportional to the velocities.
"""

from typing import Any

import numpy as np
from matplotlib.patches import Arc, Circle, Polygon, Rectangle

from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import Tables, pick, table

_ARROW = 0.2  # length for a velocity of 1, in cells
_AWAY = 0.045  # distance of a dimension line from the measured length


def measure(client: Client, *, rho: float = RHO, delta: float = 0.15, seed: int = 17) -> Tables:
    """One row: the geometry and the random start. With the default seed no arrow covers a label."""
    start = next(client.trace(rho=rho, delta=delta, seed=seed, events=1))
    row = {name: start[name] for name in ("rho", "delta", "lambda", "eta")}
    row |= {f"ball_{name}": value for name, value in start["balls"][0].items()}
    row |= {f"piston_{name}": value for name, value in start["pistons"][0].items()}
    return {"cell": table([row])}


@style.styled
def draw(tables: Tables) -> style.Figure:
    at = pick(tables["cell"], 0)
    figure = style.picture(960, 670)
    axes = style.bare_axes(figure)
    axes.set(xlim=(-0.64, 1.22), ylim=(-0.66, 0.64))
    _draw_walls(axes, at)
    _draw_parameters(axes, at)
    x, eta = at["piston_x"], at["eta"]
    axes.plot([x, x], [-eta / 2, eta / 2], color=style.BLUE, linewidth=5, solid_capstyle="butt")
    axes.plot(at["ball_x"], at["ball_y"], "o", color=style.ORANGE, markersize=9)
    for body, colour in (("piston", style.BLUE), ("ball", style.ORANGE)):
        moving = {name: at[f"{body}_{name}"] for name in ("x", "y", "vx", "vy")}
        style.arrows(axes, moving, 1 / _ARROW, color=colour, width=0.004, zorder=5)
    text = "ρ = {rho:.6g}     λ = tan θ = {lambda:.4g}     δ = {delta:.4g}     η = {eta:.4g}"
    axes.text(-0.5, 0.575, text.format(**at))
    return figure


def _draw_walls(axes: Any, at: dict[str, Any]) -> None:
    """The discs, their overlap behind the piston cell, the unit square and the cell's outline."""
    edge = {"edgecolor": style.EDGE, "linewidth": 0.8}
    for centre in cell_outline.CENTRES:
        axes.add_patch(Circle(centre, at["rho"], facecolor=style.DISC, **edge))
    overlap = cell_outline.overlap(at["rho"])
    axes.add_patch(Polygon(overlap, facecolor=style.OVERLAP))
    outline = cell_outline.outline(at["rho"])
    axes.add_patch(Polygon(outline, facecolor="white"))
    half = at["lambda"] / 2 + at["delta"]
    eta = at["eta"]
    axes.add_patch(Rectangle((0.5 - half, -eta / 2), 2 * half, eta, facecolor=style.REACH, **edge))
    axes.add_patch(Polygon(overlap, fill=False, linestyle=(0, (4, 3)), **edge))
    axes.add_patch(Rectangle((-0.5, -0.5), 1, 1, fill=False, linestyle=(0, (8, 5)), **edge))
    axes.add_patch(Polygon(outline, fill=False, edgecolor=style.BLACK, linewidth=2))


def _draw_parameters(axes: Any, at: dict[str, Any]) -> None:
    rho, eta, theta = at["rho"], at["eta"], np.arctan(at["lambda"])
    tip = 0.5 - at["lambda"] / 2
    diagonal = rho * np.sqrt(0.5)
    _dimension(axes, (-0.5, -0.5), (diagonal - 0.5, diagonal - 0.5), "ρ", (0.03, -0.05))

    _extension(axes, (0.5, 0.5), (tip, 0))
    _extension(axes, (0.5, 0.5), (0.5, 0))
    degrees = np.degrees(theta)
    axes.add_patch(Arc((0.5, 0.5), 0.5, 0.5, angle=270 - degrees, theta1=0, theta2=degrees))
    axes.text(0.5 - 0.3 * np.sin(theta / 2), 0.5 - 0.3 * np.cos(theta / 2), "θ", ha="center")

    below = -eta / 2 - 1.6 * _AWAY
    _dimension(axes, (tip, below), (1 - tip, below), "λ", (0, -0.05))
    for x in (tip, 1 - tip):
        _extension(axes, (x, 0), (x, below - 0.02))

    above = eta / 2 + _AWAY
    for side in (-1, 1):
        inner = 0.5 + side * at["lambda"] / 2
        outer = inner + side * at["delta"]
        _dimension(axes, (inner, above), (outer, above), "δ", (0, 0.04))
        _extension(axes, (inner, 0), (inner, above + 0.02))
        _extension(axes, (outer, eta / 2), (outer, above + 0.02))

    right = 0.5 + at["lambda"] / 2 + at["delta"]
    beside = right + _AWAY
    _dimension(axes, (beside, -eta / 2), (beside, eta / 2), "η", (0.03, 0))
    for y in (-eta / 2, eta / 2):
        _extension(axes, (right, y), (beside + 0.02, y))

    _dimension(axes, (-0.5, -0.555), (0.5, -0.555), "1", (0, -0.045))
    for x in (-0.5, 0.5):
        _extension(axes, (x, -0.5), (x, -0.575))


def _dimension(axes: Any, start: Any, end: Any, label: str, offset: Any) -> None:
    arrow = {"arrowstyle": "<|-|>", "shrinkA": 0, "shrinkB": 0, "color": style.BLACK}
    axes.annotate("", end, start, arrowprops=arrow)
    middle = (np.array(start) + np.array(end)) / 2 + np.array(offset)
    axes.text(*middle, label, ha="center", va="center", fontsize=14)


def _extension(axes: Any, start: Any, end: Any) -> None:
    axes.plot(*zip(start, end), color=style.EDGE, linewidth=0.9, dashes=(5, 4))
