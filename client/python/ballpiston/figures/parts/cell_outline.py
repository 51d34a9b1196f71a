"""The outline of a ball's cell: four arcs of discs of radius rho, whose centres are the corners of
the unit square around the cell. lambda = sqrt(4 rho^2 - 1) is the length of the overlap of two
neighbouring discs; the cell's tips are at a distance 1/2 - lambda/2 from its middle."""

import numpy as np

from ballpiston.figures.parts.tables import FloatArray

CENTRES = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
_WHOLE = np.linspace(0, 4, 193)


def overlap_length(rho: float) -> float:
    """lambda"""
    return float(np.sqrt(4 * rho**2 - 1))


def outline(rho: float, s: FloatArray = _WHOLE) -> FloatArray:
    """Points (n, 2) of the cell's edge, by default all around. s counts the arcs of discs 0 to 3,
    counterclockwise from the left tip: 0 to 4."""
    disc = np.minimum(np.floor(s), 3)
    x, y = np.array(CENTRES)[disc.astype(int)].T
    angles = np.pi / 4 + (0.5 - s + disc) * _angle_of_arc(rho) + disc * np.pi / 2
    return np.column_stack([x + rho * np.cos(angles), y + rho * np.sin(angles)])


def place_on_outline(
    rho: float, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """s of points on the edge, and the components of the normal into the cell."""
    disc = np.where(x < 0, np.where(y < 0, 0, 3), np.where(y < 0, 1, 2))
    centre_x, centre_y = np.array(CENTRES)[disc].T
    angles = np.arctan2(y - centre_y, x - centre_x) - disc * np.pi / 2
    share = 0.5 - (np.mod(angles, 2 * np.pi) - np.pi / 4) / _angle_of_arc(rho)
    return disc + share, (x - centre_x) / rho, (y - centre_y) / rho


def _angle_of_arc(rho: float) -> float:
    return float(np.pi / 2 - 2 * np.arctan(overlap_length(rho)))


def overlap(rho: float) -> FloatArray:
    """Points (n, 2) of the lens in which the discs 1 and 2 overlap, at the right of the cell."""
    theta = np.arctan(overlap_length(rho))
    angles = np.linspace(theta, -theta, 49)
    arc = np.column_stack([-rho * np.sin(angles), rho * np.cos(angles) - 0.5])
    lens: FloatArray = np.concatenate([arc, -arc]) + (0.5, 0)
    return lens


def half_height(rho: float, depth: FloatArray) -> FloatArray:
    """Half of the cell's height at the distance `depth` from its tip, with full precision near the
    tip too."""
    beyond = depth * (depth + overlap_length(rho))  # (depth + lambda/2)^2 - lambda^2/4
    half: FloatArray = beyond / (0.5 + np.sqrt(0.25 - beyond))
    return half
