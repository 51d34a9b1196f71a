"""The outline of a ball's cell: four arcs of discs of radius rho, whose centres are the corners of
the unit square around the cell. lambda = sqrt(4 rho^2 - 1) is the length of the overlap of two
neighbouring discs; the cell's tips are at a distance 1/2 - lambda/2 from its middle."""

from __future__ import annotations

import numpy as np

from ballpiston.figures.parts.tables import FloatArray

CENTRES = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


def overlap_length(rho: float) -> float:
    """lambda"""
    return float(np.sqrt(4 * rho**2 - 1))


def arc(rho: float, disc: int, count: int = 49) -> FloatArray:
    """Points (count, 2) of the arc of a disc, from tip to tip. The four arcs of discs 0 to 3 go
    around the cell, counterclockwise from its left tip."""
    theta = np.arctan(overlap_length(rho))
    angles = np.linspace(theta, np.pi / 2 - theta, count)[::-1] + disc * np.pi / 2
    return circle(rho, disc, angles)


def circle(rho: float, disc: int, angles: FloatArray) -> FloatArray:
    """Points (angles, 2) of a disc's edge."""
    x, y = CENTRES[disc]
    return np.column_stack([x + rho * np.cos(angles), y + rho * np.sin(angles)])


def outline(rho: float) -> FloatArray:
    """Points (n, 2) of the whole cell, counterclockwise from its left tip."""
    return np.concatenate([arc(rho, disc) for disc in range(4)])


def overlap(rho: float) -> FloatArray:
    """Points (n, 2) of the lens in which the discs 1 and 2 overlap, at the right of the cell."""
    theta = np.arctan(overlap_length(rho))
    angles = np.linspace(theta, -theta, 49)
    return np.concatenate(
        [circle(rho, 1, np.pi / 2 + angles), circle(rho, 2, -np.pi / 2 + angles)]
    )


def half_height(rho: float, x: FloatArray) -> FloatArray:
    """Of the cell at x, measured from its middle."""
    half: FloatArray = 0.5 - np.sqrt(rho**2 - (0.5 - np.abs(x)) ** 2)
    return half
