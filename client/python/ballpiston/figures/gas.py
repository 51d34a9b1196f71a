"""A random configuration of the gas of balls and pistons (the paper's figure of the gas)

Each ball moves in its cell between four discs. Each piston, a segment, moves through the overlap of
two discs from one cell into the next. An arrow is proportional to the velocity; its colour shows
the kinetic energy. The gas is periodic: the pistons of the first column and row are drawn again at
the last column and row.
"""

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon, Rectangle

from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import Table, Tables, pick, stacked, table

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
    gas: dict[str, Any] = {"rho": rho, "delta": delta, "cells": cells, "temperature": temperature}
    start = next(client.trace(events=1, seed=seed, **gas))
    columns, _, lines = start["cells"].partition("x")
    row = {name: start[name] for name in ("rho", "delta", "lambda", "eta", "temperature")}
    row |= {"columns": int(columns), "rows": int(lines or 1)}
    return {
        "gas-balls": table(start["balls"]),
        "gas-pistons": table(start["pistons"]),
        "gas-geometry": table([row]),
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    at = pick(tables["gas-geometry"], 0)
    wide, high = at["columns"] + 2 * _MARGIN, at["rows"] + 2 * _MARGIN
    figure = style.picture(960, max(260.0, 840 * high / wide))
    axes = style.bare_axes(figure)
    corner = np.array([-0.5 - _MARGIN, -0.5 - _MARGIN])
    axes.set(xlim=(corner[0], corner[0] + wide), ylim=(corner[1], corner[1] + high))
    axes.add_patch(Rectangle(corner, wide, high, facecolor=style.DISC))
    pistons = _with_copies(tables["gas-pistons"], at)
    place = np.column_stack([pistons["x"], pistons["y"]])
    is_along = np.column_stack([pistons["vertical"], ~pistons["vertical"]])  # moves along x, or y
    half = np.where(is_along, at["lambda"] / 2 + at["delta"], at["eta"] / 2)
    # A piston's cell is around the edge of the ball's cell that is nearest.
    corners = np.where(is_along, np.floor(place) + 0.5, place) - half
    reaches = [(corner, *size) for corner, size in zip(corners, 2 * half)]
    for reach in reaches:
        axes.add_patch(Rectangle(*reach, facecolor="#efefef", edgecolor=style.EDGE))
    for cell in np.ndindex(int(at["columns"]), int(at["rows"])):
        outline = cell_outline.outline(at["rho"]) + np.array(cell)
        axes.add_patch(Polygon(outline, facecolor="white", edgecolor=style.EDGE, linewidth=1.2))
    for reach in reaches:
        axes.add_patch(Rectangle(*reach, fill=False, edgecolor=style.EDGE, linestyle=(0, (4, 4))))
    scale = style.energy_bar(figure, axes, _BRIGHTEST, "energy/T", shrink=0.7, pad=0.01)
    half = np.where(is_along, 0, at["eta"] / 2)
    segments = np.stack([place - half, place + half], axis=1)
    balls = tables["gas-balls"]
    colours = [scale.to_rgba(body["energy"] / at["temperature"]) for body in (pistons, balls)]
    for body, colour in zip((pistons, balls), colours):
        unit = np.sqrt(at["temperature"]) / _ARROW
        style.arrows(axes, body, unit, color=colour, width=0.003, zorder=4)
    shown: dict[str, Any] = {"linewidths": 4, "capstyle": "butt", "zorder": 2}
    axes.add_collection(LineCollection(segments, colors=colours[0], **shown))
    axes.scatter(balls["x"], balls["y"], c=colours[1], s=36, zorder=4)
    return figure


def _with_copies(pistons: Table, at: dict[str, Any]) -> Table:
    """With those of the first column and row again at the opposite end of the periodic gas."""
    copies = pick(pistons, np.where(pistons["vertical"], pistons["x"], pistons["y"]) < 0)
    copies["x"] = copies["x"] + np.where(copies["vertical"], at["columns"], 0)
    copies["y"] = copies["y"] + np.where(copies["vertical"], 0, at["rows"])
    return stacked([pistons, copies])
