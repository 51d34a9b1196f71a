"""Velocities with which ball and piston leave a collision, at one energy (a figure of the paper)

Velocities (v1, v2, v3) of ball and piston are points of the unit sphere. The outgoing velocities of
the collision surface, with normal n = (-1, 0, 1)/sqrt 2, are the hemisphere above its tangent
plane. At the piston's energy epsilon the velocities lie on two circles, v3 = sigma sqrt(2 epsilon).
The parts above the plane contribute to the rate of collisions, the other parts (pale) do not. Below
epsilon = 1/4 both circles contribute, above 1/4 one circle.
"""

from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import FloatArray, Tables, closed_forms


def measure(
    client: Client, *, rho: float = RHO, delta: float = 0.1, epsilon: float = 0.125
) -> Tables:
    """One row. The server judges the energy; the picture depends neither on rho nor on delta."""
    forms = client.analytic(rho, delta, epsilon)
    return {"collision-surface": closed_forms(forms, "rho", "delta", "epsilon")}


@style.styled
def draw(tables: Tables) -> style.Figure:
    epsilon = float(tables["collision-surface"]["epsilon"][0])
    figure = style.picture(960, 800)
    axes = figure.add_subplot(projection="3d", computed_zorder=False, elev=22, azim=-50)
    axes.set_axis_off()
    axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    axes.set_box_aspect((1, 1, 1), zoom=1.35)
    turn = np.linspace(0, 2 * np.pi, 181)
    rim = _in_plane_frame(np.zeros_like(turn), np.cos(turn), np.sin(turn))
    axes.add_collection3d(Poly3DCollection([rim], facecolor="#c9d3ea", alpha=0.8))
    rise, around = np.meshgrid(np.linspace(0, np.pi / 2, 91), turn, indexing="ij")
    across = np.cos(rise) * np.cos(around), np.cos(rise) * np.sin(around)
    net = np.moveaxis(_in_plane_frame(np.sin(rise), *across), -1, 0)
    axes.plot_wireframe(*net, rstride=15, cstride=15, color="#b4b4b4", linewidth=0.8)
    for sigma in (-1, 1):
        _draw_circle(axes, epsilon, sigma)
    normal = 1.22 * np.array([-1, 0, 1]) / np.sqrt(2)
    axes.quiver(0, 0, 0, *normal, color=style.BLUE, linewidth=2.5, arrow_length_ratio=0.1)
    axes.text(*(1.08 * normal), "n", color=style.BLUE)
    style.axis_arrows(axes, (-1.0, -0.9, -1.1), 0.42, ("v₁", "v₂", "v₃"))
    for height, text, colour in (
        (0.96, "above the plane", style.GREEN),
        (0.92, "below the plane", style.GREY),
        (0.88, "tangent plane, normal n", style.BLUE),
    ):
        axes.text2D(0.97, height, text, color=colour, ha="right", transform=axes.transAxes)
    axes.text2D(0.03, 0.96, f"ε = {epsilon:.6g}", transform=axes.transAxes)
    return figure


def _in_plane_frame(n: FloatArray, t: FloatArray, v2: FloatArray) -> FloatArray:
    """From components along n, t = (1, 0, 1)/sqrt 2 and v2."""
    return np.stack([(t - n) / np.sqrt(2), v2, (t + n) / np.sqrt(2)], axis=-1)


def _draw_circle(axes: Any, epsilon: float, sigma: int) -> None:
    """v3 = sigma sqrt(2 epsilon). The part above the tangent plane, v3 - v1 >= 0, is green."""
    alpha = np.linspace(0, 2 * np.pi, 721)
    height = sigma * np.sqrt(2 * epsilon)
    v1, v2 = np.sqrt(1 - 2 * epsilon) * np.array([np.cos(alpha), np.sin(alpha)])
    points = np.column_stack([v1, v2, np.full_like(alpha, height)])
    is_above = height - v1 >= 0
    for included, colour in ((False, "#c8c8c8"), (True, style.GREEN)):
        part = np.where((is_above == included)[:, np.newaxis], points, np.nan)
        axes.plot(*part.T, color=colour, linewidth=4)
    end = np.sqrt(0.5 - epsilon)
    sign = "" if sigma > 0 else "-"
    axes.text(1.15 * end, 1.15 * end, height, f"  v₃ = {sign}√(2ε)", va="center")
