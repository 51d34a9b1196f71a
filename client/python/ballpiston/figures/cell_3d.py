"""Ball and piston as one billiard in three dimensions (a figure of the paper)

The ball at (q1, q2) and the piston at q3 are one point of a three-dimensional billiard, seen here
from below. Its vertical walls stand on the arcs of the ball's cell; its floor and ceiling are the
piston's walls. The ball is left of the piston. Therefore the slanted plane q1 = q3, the collision
surface, cuts off the lower end of the right tip.
"""

from typing import Any

import numpy as np
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import FloatArray, Tables, closed_forms, pick

_WALL, _FLOOR, _EDGE = "#c3cfe6", "#f4f4f4", "#404040"
_HIGHEST, _LOWEST = 1.1, 0.6  # heights of the drawing, in units of its width


def measure(client: Client, *, rho: float = RHO, delta: float = 0.15) -> Tables:
    forms = client.analytic(rho, delta)
    return {"cell-3d": closed_forms(forms, "rho", "delta", "lambda", "eta")}


@style.styled
def draw(tables: Tables) -> style.Figure:
    at = pick(tables["cell-3d"], 0)
    tip = float(0.5 - at["lambda"] / 2)
    low = float(tip - at["delta"])
    stretch = float(np.clip((1 - 2 * low) / (2 * tip), _LOWEST, _HIGHEST)) * 2 * tip / (1 - 2 * low)
    ceiling = low + stretch * (1 - 2 * low)

    def bottom(x: FloatArray) -> FloatArray:
        """The walls' lower end: the floor or, right of it, the collision surface."""
        return low + stretch * np.maximum(x - low, 0)

    figure = style.picture(960, 800)
    axes = figure.add_subplot(projection="3d", computed_zorder=False, elev=-28, azim=-62)
    axes.set_axis_off()
    axes.set(xlim=(-tip, tip), ylim=(-tip, tip), zlim=(low, ceiling))
    axes.set_box_aspect((1, 1, (ceiling - low) / (2 * tip)), zoom=1.15)
    for depth, disc in enumerate((3, 2, 0, 1)):  # from the back to the front
        x, y = cell_outline.outline(at["rho"], disc + np.linspace(0, 1, 49)).T
        wall = np.array([x, x]), np.array([y, y]), np.array([bottom(x), np.full_like(x, ceiling)])
        light: dict[str, Any] = {"lightsource": LightSource(130, 0), "ccount": len(x)}
        axes.plot_surface(*wall, color=_WALL, antialiased=False, zorder=depth, **light)
        edges = (np.concatenate([a, b[::-1], a[:1]]) for a, b in wall)
        axes.plot(*edges, color=_EDGE, linewidth=1.2, zorder=depth)
    _draw_strip(axes, at["rho"], np.linspace(-tip, low, 60), bottom, _FLOOR)
    _draw_strip(axes, at["rho"], np.linspace(low, tip, 60), bottom, style.ORANGE)
    style.axis_arrows(axes, (0.9 * tip, 0.3 * tip, low), 0.35 * tip, ("q₁", "q₂", "q₃"))
    for place, text, more in (
        ((0.62, 0.03), "collision surface: q₁ = q₃", {"color": style.ORANGE}),
        ((0.03, 0.03), "floor: q₃ = 1/2 - λ/2 - δ", {}),
        ((0.62, 0.95), "ceiling: q₃ = 1/2 + λ/2 + δ", {}),
        ((0.03, 0.95), "blue: walls of the discs", {}),
    ):
        axes.text2D(*place, text, transform=axes.transAxes, **more)
    if abs(stretch - 1) > 1e-12:
        axes.text2D(0.62, 0.91, f"heights drawn × {stretch:.2g}", transform=axes.transAxes)
    return figure


def _draw_strip(axes: Any, rho: float, x: FloatArray, bottom: Any, colour: str) -> None:
    """Of the floor or the collision surface, between the lower and the upper arcs."""
    tip = 0.5 - cell_outline.overlap_length(rho) / 2
    half = cell_outline.half_height(rho, tip - np.abs(x))
    there, back = (np.column_stack([x, y, bottom(x)]) for y in (half, -half))
    face = [np.concatenate([there, back[::-1]])]
    axes.add_collection3d(Poly3DCollection(face, facecolor=colour, edgecolor=_EDGE, zorder=9))
