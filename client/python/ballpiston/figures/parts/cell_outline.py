"""The outline of a ball's cell: four arcs of discs of radius rho, whose centres are the corners of
the unit square around the cell. lambda = sqrt(4 rho^2 - 1) is the length of the overlap of two
neighbouring discs; the cell's tips are at a distance 1/2 - lambda/2 from its middle."""

import numpy as np

from ballpiston.figures.parts.tables import FloatArray

CENTRES = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


def overlap_length(rho: float) -> float:
    """lambda"""
    return float(np.sqrt(4 * rho**2 - 1))


def arc(rho: float, disc: int, count: int = 49) -> FloatArray:
    """Points (count, 2) of the arc of a disc, from tip to tip. The four arcs of discs 0 to 3 go
    around the cell, counterclockwise from its left tip."""
    return point_of_outline(rho, disc + np.linspace(0, 1, count))


def circle(rho: float, disc: int, angles: FloatArray) -> FloatArray:
    """Points (angles, 2) of a disc's edge."""
    x, y = CENTRES[disc]
    return np.column_stack([x + rho * np.cos(angles), y + rho * np.sin(angles)])


def point_of_outline(rho: float, s: FloatArray) -> FloatArray:
    """Points (n, 2) of the whole cell. s counts arcs from the left tip, counterclockwise: 0 to 4."""
    disc = np.minimum(np.floor(s), 3)
    x, y = np.array(CENTRES)[disc.astype(int)].T
    angles = _first_angle(rho) - (s - disc) * _angle_of_arc(rho) + disc * np.pi / 2
    return np.column_stack([x + rho * np.cos(angles), y + rho * np.sin(angles)])


def place_on_outline(
    rho: float, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """s of points on the edge, and the components of the normal into the cell."""
    disc = np.where(x < 0, np.where(y < 0, 0, 3), np.where(y < 0, 1, 2))
    centre_x, centre_y = np.array(CENTRES)[disc].T
    angles = np.arctan2(y - centre_y, x - centre_x) - disc * np.pi / 2
    share = (_first_angle(rho) - np.mod(angles, 2 * np.pi)) / _angle_of_arc(rho)
    return disc + share, (x - centre_x) / rho, (y - centre_y) / rho


def _first_angle(rho: float) -> float:
    """Of disc 0 at the left tip."""
    return float(np.pi / 2 - np.arctan(overlap_length(rho)))


def _angle_of_arc(rho: float) -> float:
    return float(2 * _first_angle(rho) - np.pi / 2)


def outline(rho: float) -> FloatArray:
    """Points (n, 2) of the whole cell, counterclockwise from its left tip."""
    return np.concatenate([arc(rho, disc) for disc in range(4)])


def overlap(rho: float) -> FloatArray:
    """Points (n, 2) of the lens in which the discs 1 and 2 overlap, at the right of the cell."""
    theta = np.arctan(overlap_length(rho))
    angles = np.linspace(theta, -theta, 49)
    return np.concatenate([circle(rho, 1, np.pi / 2 + angles), circle(rho, 2, -np.pi / 2 + angles)])


def half_height(rho: float, depth: FloatArray) -> FloatArray:
    """Half of the cell's height at the distance `depth` from its tip, with full precision near the
    tip too."""
    beyond = depth * (depth + overlap_length(rho))  # (depth + lambda/2)^2 - lambda^2/4
    half: FloatArray = beyond / (0.5 + np.sqrt(0.25 - beyond))
    return half
