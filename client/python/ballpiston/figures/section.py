"""The collisions of ball and piston as a section of the orbits, beside their invariant density

Each collision is a point of the collision surface. The invariant measure of the map from collision
to collision is dq dv (v.n), the paper's measure nu_bp: positions q are uniform on the surface, and
velocities v on the unit sphere have a density proportional to v.n = (vx - p)/sqrt 2 > 0, where vx
and p are the velocities of ball and piston along x before the collision.

In spherical coordinates p = +-u, with u = sqrt(2 epsilon) for the piston's energy epsilon, the
ball's velocity is sqrt(1 - u^2) (cos alpha, sin alpha), and dv = du dalpha. The integral of vx - p
over its hemisphere is sqrt(2) pi. So alpha and u have the density, summed over the signs of p,
  f(alpha, u) = sum of max(0, sqrt(1 - u^2) cos(alpha) - p) / (sqrt(2) pi).

The ball's height y is independent of velocities. At y the surface has the depths s(y) to delta,
with (s + lambda/2)^2 = rho^2 - (1/2 - |y|)^2, so y has a density proportional to delta - s(y). Bins
are equal in energy; densities are those of u, finite at 0. Time: default 10 s, full 30 s of a core.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ballpiston.client import Client
from ballpiston.collisions import Records
from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, rows, stacked, table

EFFORT = {"quick": {"collisions": 1e4, "bins": 12}, "full": {"collisions": 3e6, "bins": 50}}

_FINER = 16  # points in a bin along each axis, for exact means
_FEWEST = 10.0  # expected collisions in a bin that counts for chi-squared


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.1,
    collisions: float = 1e6,
    bins: int = 30,
    seed: int = 0,
) -> Tables:
    """Collisions in equilibrium, in bins of alpha or y and of the piston's energy; their exact
    densities; and chi-squared, to which the correlation of collisions adds a few units only."""
    question = {"rho": rho, "delta": delta, "collisions": collisions, "seed": seed}
    hits = client.sample("equilibrium", model="billiard", **question).all()
    angles = np.arctan2(hits["ball_vy"], hits["ball_vx"])
    height = client.analytic(rho, delta)["eta"][0]
    symmetric, energies = np.linspace(-1, 1, bins + 1), np.linspace(0, 0.5, bins + 1)
    alpha, y, u = np.pi * symmetric, height / 2 * symmetric, _finer(np.sqrt(2 * energies))
    velocities = density_of_velocities(_finer(alpha)[:, np.newaxis], u)
    heights = density_of_heights(rho, delta, _finer(y))[:, np.newaxis]
    products = heights / (height * heights.mean()) * 2 * np.pi * velocities.mean(axis=0)
    sections = [
        _section("alpha", [alpha, energies], angles, hits, velocities),
        _section("y", [y, energies], hits["y"], hits, products),
    ]
    return {"section": stacked(sections), "section-test": table(map(_chi_squared, sections))}


def density_of_velocities(alpha: FloatArray, u: FloatArray) -> FloatArray:
    """f(alpha, u)."""
    along = np.sqrt(1 - u**2) * np.cos(alpha)
    f: FloatArray = (np.maximum(along - u, 0) + np.maximum(along + u, 0)) / (np.sqrt(2) * np.pi)
    return f


def density_of_heights(rho: float, delta: float, y: FloatArray) -> FloatArray:
    """delta - s(y), the density of y up to its norm."""
    depth = np.sqrt(rho**2 - (0.5 - np.abs(y)) ** 2) - np.sqrt(rho**2 - 0.25)
    density: FloatArray = np.maximum(delta - depth, 0)
    return density


def _finer(edges: FloatArray) -> FloatArray:
    """The middles of _FINER parts of each bin."""
    parts = (np.arange(_FINER) + 0.5) / _FINER
    middles: FloatArray = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * parts
    return middles.ravel()


def _section(name: str, edges: Any, of: FloatArray, hits: Records, finer: FloatArray) -> Table:
    """One row for each bin. `finer` has the exact density at _FINER^2 points of each."""
    count, _, _ = np.histogram2d(of, hits["piston_energy"], edges)
    weight = len(hits) * np.outer(np.diff(edges[0]), np.diff(np.sqrt(2 * edges[1])))
    lower, epsilon = np.meshgrid(edges[0][:-1], edges[1][:-1], indexing="ij")
    exact = finer.reshape(len(count), _FINER, -1, _FINER).mean(axis=(1, 3))
    columns: Table = {"section": np.full(count.size, name), "lower": lower, "epsilon": epsilon}
    columns |= {"count": count, "expected": exact * weight}
    columns |= {"density": count / weight, "exact_density": exact}
    return {name: column.ravel() for name, column in columns.items()}


def _chi_squared(section: Table) -> dict[str, Any]:
    found = {name: column[section["expected"] >= _FEWEST] for name, column in section.items()}
    terms = (found["count"] - found["expected"]) ** 2 / found["expected"]
    return {"section": section["section"][0], "chi_squared": terms.sum(), "bins": len(terms)}


@style.styled
def draw(tables: Tables) -> Figure:
    """Collisions left, their exact density right."""
    figure = style.picture(960, 800)
    panels = figure.subplots(2, 2, sharey=True, sharex="row")
    for line, letters, (name, label) in zip(panels, ("ab", "cd"), (("alpha", "α"), ("y", "y"))):
        part = rows(tables["section"], section=name)
        for axes, letter, column in zip(line, letters, ("density", "exact_density")):
            x, y = (np.unique(part[edges]) for edges in ("lower", "epsilon"))
            box = (x[0], 2 * x[-1] - x[-2], 0, 2 * y[-1] - y[-2])
            shown: dict[str, Any] = {"origin": "lower", "aspect": "auto", "cmap": style.ENERGY}
            shown |= {"vmin": 0, "vmax": part["exact_density"].max(), "extent": box}
            axes.imshow(part[column].reshape(len(x), -1).T, **shown)
            axes.grid(False)
            axes.set(xlabel=label)
            style.title(axes, letter, "collisions" if column == "density" else "exact density")
        line[0].set(ylabel="piston energy ε")
    return figure
