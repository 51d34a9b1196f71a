"""Sections of the orbits: collisions of ball and piston, and wall hits, beside their exact densities

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
are equal in energy; densities are those of u, finite at 0.

The ball's wall hits, of one long orbit, are points of its boundary map: s along the cell's edge, and
the angle phi of the outgoing velocity to the normal. s counts arcs, from the left tip
counterclockwise. The invariant density is uniform in sin(phi), and proportional to the length of the
piston's stroke that is on the right of s. Time: default 25 s, full 60 s of a core.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import cell_outline, style
from ballpiston.figures.parts.asking import RHO, Client
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, pick, rows, stacked, table

EFFORT = {
    "quick": {"collisions": 1e4, "events": 1e4, "bins": 12},
    "full": {"collisions": 3e6, "events": 1e6, "bins": 50},
}

_FINER = 16  # points in a bin along each axis, for exact means
_FIELDS_OF_A_HIT = ("event", "ball_x", "ball_y", "ball_vx", "ball_vy")
_FEWEST = 10.0  # expected collisions in a bin that counts for chi-squared
_AXES = {
    "alpha": ("direction of the ball α", "piston energy ε"),
    "y": ("place y", "piston energy ε"),
    "s": ("place along the edge s, in arcs", "sin φ"),
}


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.1,
    collisions: float = 1e6,
    events: float = 3e5,
    bins: int = 30,
    seed: int = 0,
) -> Tables:
    """Collisions in equilibrium, in bins of alpha or y and of the piston's energy; wall hits among
    the events of an orbit, in bins of s and sin(phi); their exact densities; and chi-squared, to
    which the correlation of collisions and of hits adds a few units only."""
    if not 2 <= bins <= 300:  # 300: the densities take 1 GiB
        raise ValueError(f"bins is {bins}; permitted: 2 to 300")
    question: dict[str, Any] = {"rho": rho, "delta": delta, "seed": seed}
    hits = client.sample("equilibrium", model="billiard", collisions=collisions, **question).all()
    orbit = client.trace_arrays(*_FIELDS_OF_A_HIT, events=events, **question)
    sections = [*_of_collisions(client, rho, delta, hits, bins), _of_walls(rho, delta, orbit, bins)]
    return {"section": stacked(sections), "section-test": table(map(_chi_squared, sections))}


def _of_collisions(
    client: Client, rho: float, delta: float, hits: Any, bins: int
) -> tuple[Table, Table]:
    """In alpha and in y, and in the energy."""
    height = client.analytic(rho, delta)["eta"][0]
    symmetric, energies = np.linspace(-1, 1, bins + 1), np.linspace(0, 0.5, bins + 1)
    alpha, y, u = np.pi * symmetric, height / 2 * symmetric, np.sqrt(2 * energies)
    p = _finer(u)
    along = np.sqrt(1 - p**2) * np.cos(_finer(alpha)[:, np.newaxis])
    velocities = (np.maximum(along - p, 0) + np.maximum(along + p, 0)) / (np.sqrt(2) * np.pi)  # f
    depths = np.sqrt(rho**2 - (0.5 - np.abs(_finer(y))) ** 2) - np.sqrt(rho**2 - 0.25)  # s(y)
    heights = np.maximum(delta - depths, 0)[:, np.newaxis]
    products = heights / (height * heights.mean()) * 2 * np.pi * velocities.mean(axis=0)
    angles, energy = np.arctan2(hits["ball_vy"], hits["ball_vx"]), hits["piston_energy"]
    return (
        _section("alpha", (angles, energy), (alpha, energies), (alpha, u), velocities),
        _section("y", (hits["y"], energy), (y, energies), (y, u), products),
    )


def _of_walls(rho: float, delta: float, orbit: Table, bins: int) -> Table:
    """In s and in sin(phi)."""
    x, y, vx, vy = (orbit[name][orbit["event"] == "ball_wall"] for name in _FIELDS_OF_A_HIT[1:])
    edges = np.linspace(0, 4, bins + 1), np.linspace(-1, 1, bins + 1)
    stroke = cell_outline.overlap_length(rho) + 2 * delta
    places = cell_outline.outline(rho, _finer(edges[0]))[:, 0]
    strokes = np.minimum(stroke, 0.5 + stroke / 2 - places)
    exact = np.outer(strokes / (4 * strokes.mean()), np.full(_FINER * bins, 0.5))
    s, normal_x, normal_y = cell_outline.place_on_outline(rho, x, y)
    sines = (normal_x * vy - normal_y * vx) / np.hypot(vx, vy)
    return _section("s", (s, sines), edges, edges, exact)


def _finer(edges: FloatArray) -> FloatArray:
    """The middles of _FINER parts of each bin."""
    parts = (np.arange(_FINER) + 0.5) / _FINER
    middles: FloatArray = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * parts
    return middles.ravel()


def _section(name: str, points: Any, edges: Any, scaled: Any, exact: FloatArray) -> Table:
    """One row for each bin. `scaled`: the edges in the variables of the density; `exact` has it at
    _FINER^2 points of each bin."""
    count, _, _ = np.histogram2d(points[0], points[1], edges)
    weight = len(points[0]) * np.outer(*map(np.diff, scaled))
    expected = exact.reshape(len(count), _FINER, -1, _FINER).mean(axis=(1, 3))
    first, second = np.meshgrid(edges[0][:-1], edges[1][:-1], indexing="ij")
    columns: Table = {"section": np.full(count.size, name), "first": first, "second": second}
    columns |= {"count": count, "expected": expected * weight}
    columns |= {"density": count / weight, "exact_density": expected}
    return {name: column.ravel() for name, column in columns.items()}


def _chi_squared(section: Table) -> dict[str, Any]:
    found = pick(section, section["expected"] >= _FEWEST)
    terms = (found["count"] - found["expected"]) ** 2 / found["expected"]
    return {"section": section["section"][0], "chi_squared": terms.sum(), "bins": len(terms)}


@style.styled
def draw(tables: Tables) -> style.Figure:
    titles = ("collisions", "exact density") * 2 + ("wall hits", "exact density")
    figure, panels = style.panels((960, 1180), 3, 2, titles, sharey="row", sharex="row")
    for line, (name, labels) in zip(panels, _AXES.items()):
        part = rows(tables["section"], section=name)
        for axes, column in zip(line, ("density", "exact_density")):
            x, y = (np.unique(part[edges]) for edges in ("first", "second"))
            most = max(part["density"].max(), part["exact_density"].max())
            box = (x[0], 2 * x[-1] - x[-2], y[0], 2 * y[-1] - y[-2])
            shown: dict[str, Any] = {"origin": "lower", "aspect": "auto", "cmap": style.ENERGY}
            shown |= {"vmin": 0, "vmax": most, "extent": box}
            axes.imshow(part[column].reshape(len(x), -1).T, **shown)
            axes.grid(False)
            axes.set(xlabel=labels[0])
        line[0].set(ylabel=labels[1])
    return figure
