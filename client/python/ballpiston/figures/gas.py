"""A random configuration of the gas of balls and pistons (the paper's figure of the gas)

Each ball moves in its cell between four discs. Each piston, a segment, moves through the overlap of
two discs from one cell into the next. An arrow is proportional to the velocity; its colour shows
the kinetic energy. The gas is periodic: the pistons of the first column and row are drawn again at
the last column and row.
"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from ballpiston.client import Client
from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, start_of
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, pick, stacked, table

_ARROW = 0.13  # length for a thermal velocity, sqrt(T), in cells
_BRIGHTEST = 4.0  # the colour is the same for all higher energies, in units of T
_MARGIN = 0.22  # of discs around the gas, in cells


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.15,
    cells: str = "6x4",
    temperature: float = 1,
    seed: int = 0,
) -> Tables:
    """The start of an orbit: all balls, all pistons, and one row with the geometry. `cells` is a
    lattice, NxM, or a chain, N."""
    orbit = {"rho": rho, "delta": delta, "cells": cells, "temperature": temperature}
    start = start_of(client, seed=seed, **orbit)
    columns, _, lines = start["cells"].partition("x")
    row = {name: start[name] for name in ("rho", "delta", "lambda", "eta", "temperature")}
    row |= {"columns": int(columns), "rows": int(lines or 1)}
    return {
        "gas-balls": table(start["balls"]),
        "gas-pistons": table(start["pistons"]),
        "gas-geometry": table([row]),
    }


@style.styled
def draw(tables: Tables) -> Figure:
    """The gas, with a scale of energies."""
    at = pick(tables["gas-geometry"], 0)
    wide, high = at["columns"] + 2 * _MARGIN, at["rows"] + 2 * _MARGIN
    figure = style.picture(960, max(260.0, 840 * high / wide))
    axes = style.bare_axes(figure)
    corner = np.array([-0.5 - _MARGIN, -0.5 - _MARGIN])
    axes.set(xlim=(corner[0], corner[0] + wide), ylim=(corner[1], corner[1] + high))
    axes.add_patch(Rectangle(corner, wide, high, facecolor=style.DISC))
    pistons = _with_copies(tables["gas-pistons"], at)
    reaches = [_piston_cell(body, at) for body in _rows(pistons)]
    for reach in reaches:
        axes.add_patch(Rectangle(*reach, facecolor="#efefef", edgecolor=style.EDGE))
    for i in range(int(at["columns"])):
        for j in range(int(at["rows"])):
            outline = cell_outline.outline(at["rho"]) + np.array([i, j])
            axes.add_patch(Polygon(outline, facecolor="white", edgecolor=style.EDGE, linewidth=1.2))
    for reach in reaches:
        axes.add_patch(Rectangle(*reach, fill=False, edgecolor=style.EDGE, linestyle=(0, (4, 4))))
    scale = style.energy_bar(figure, axes, _BRIGHTEST, "energy/T", shrink=0.7, pad=0.01)
    _draw_pistons(axes, pistons, at, scale)
    _draw_arrows(axes, tables["gas-balls"], at, scale)
    balls = tables["gas-balls"]
    colours = scale.to_rgba(balls["energy"] / at["temperature"])
    axes.scatter(balls["x"], balls["y"], c=colours, s=36, zorder=4)
    return figure


def _with_copies(pistons: Table, at: dict[str, Any]) -> Table:
    """With those of the first column and row again at the opposite end of the periodic gas."""
    is_first = np.where(pistons["vertical"], pistons["x"], pistons["y"]) < 0
    copies = pick(pistons, is_first)
    copies["x"] = copies["x"] + np.where(copies["vertical"], at["columns"], 0)
    copies["y"] = copies["y"] + np.where(copies["vertical"], 0, at["rows"])
    return stacked([pistons, copies])


def _rows(whole: Table) -> list[dict[str, Any]]:
    return [dict(zip(whole, row)) for row in zip(*whole.values())]


def _piston_cell(piston: dict[str, Any], at: dict[str, Any]) -> tuple[FloatArray, float, float]:
    """Corner, width and height. It is around the edge of the ball's cell that is nearest."""
    reach = at["lambda"] + 2 * at["delta"]
    middle = np.array([piston["x"], piston["y"]])
    along = 0 if piston["vertical"] else 1
    middle[along] = np.floor(middle[along]) + 0.5
    size = np.array([reach, at["eta"]] if piston["vertical"] else [at["eta"], reach])
    return middle - size / 2, float(size[0]), float(size[1])


def _draw_pistons(axes: Any, pistons: Table, at: dict[str, Any], scale: Any) -> None:
    for body in _rows(pistons):
        half = at["eta"] / 2 * np.array([0, 1] if body["vertical"] else [1, 0])
        ends = np.array([body["x"], body["y"]]) + np.outer([-1, 1], half)
        colour = scale.to_rgba(body["energy"] / at["temperature"])
        axes.plot(*ends.T, color=colour, linewidth=4, solid_capstyle="butt")
    _draw_arrows(axes, pistons, at, scale)


def _draw_arrows(axes: Any, bodies: Table, at: dict[str, Any], scale: Any) -> None:
    length = _ARROW / np.sqrt(at["temperature"])
    colours = scale.to_rgba(bodies["energy"] / at["temperature"])
    axes.quiver(
        *(bodies[name] for name in ("x", "y", "vx", "vy")),
        color=colours,
        angles="xy",
        scale_units="xy",
        scale=1 / length,
        width=0.003,
        zorder=4,
    )
