"""The jump kernel W, exact and from the billiard's orbits: the piston's energy after a collision

The density W/f of the piston's energy after a collision, for several energies before it. Lines: the
exact kernel, which diverges at 0 and at the largest energy, 1/2 - epsilon. Points: collisions of
the billiard, with one standard error. Time on two cores: quick 2 s, default 4 s, full 15 s.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers
from ballpiston.figures.parts.tables import Table, Tables, measured, rows, stacked

EFFORT = {"quick": {"collisions": 1e4, "bins": 8}, "full": {"collisions": 3e6, "bins": 40}}

_WINDOW = 0.0125  # half width of the interval of energies around each epsilon
_MARGIN = 4  # windows below the largest outgoing energy, without bins
_HIGHEST = 3.2  # density of a panel, in units of its mean


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.3,
    epsilon: Numbers = "0.05,0.125,0.25,0.4",
    seed: int = 0,
    collisions: float = 2e5,
    bins: int = 20,
) -> Tables:
    """The exact densities at 499 energies after a collision, and the measured ones in bins. W
    depends neither on rho nor on delta."""
    if not 1 <= bins <= 10_000:
        raise ValueError(f"bins is {bins}; permitted: 1 to 10000")
    forms = client.analytic(rho, delta, epsilon, outgoing_epsilon="0.001:0.499:499")
    energies = forms["epsilon"][0]
    outgoing = np.arange(1, 500) / 1000
    exact = stacked(  # W is a density of rates
        {"epsilon": energy, "outgoing": outgoing, "density": kernel / rate}
        for energy, rate, kernel in zip(energies, forms["f"][0], forms["kernel"][0])
    )
    question: dict[str, Any] = {"rho": rho, "delta": delta, "model": "billiard", "seed": seed}
    names = ("piston_energy", "piston_energy_after")
    sample = client.sample("equilibrium", collisions=collisions, **question)
    parts = [[part[name].copy() for name in names] for part in sample]
    hits = dict(zip(names, map(np.concatenate, zip(*parts))))
    return {"kernel-exact": exact, "kernel-measured": densities(energies, hits, bins)}


def densities(energies: Iterable[float], collisions: Table, bins: int) -> Table:
    """Of the energy after the collisions whose energy before is near each of the energies.

    The bins have equal widths in u = sqrt(2 epsilon) after the collision, because the density of u
    is finite at 0. They end four windows below the largest outgoing energy, 1/2 - epsilon, where W
    diverges: nearer to it, the mean over a window is above W by more than 2 %. Energies without a
    collision or without a bin are left out. An empty bin has the error of one collision."""
    found = []
    for energy in energies:
        is_near = np.abs(collisions["piston_energy"] - energy) < _WINDOW
        chosen = collisions["piston_energy_after"][is_near]
        end = 1 - 2 * (energy + _MARGIN * _WINDOW)
        if end <= 0 or not len(chosen):
            continue
        edges = np.linspace(0, np.sqrt(end), bins + 1)
        u = (edges[:-1] + edges[1:]) / 2
        counts, _ = np.histogram(np.sqrt(2 * chosen), edges)
        scale = len(chosen) * u * np.sqrt(end) / bins
        error = np.sqrt(np.maximum(counts, 1)) / scale
        part = {"epsilon": energy, "outgoing": u**2 / 2, "density": counts / scale}
        found.append(part | {"standard_error": error, "count": counts, "samples": len(chosen)})
    return stacked(found)


@style.styled
def draw(tables: Tables) -> style.Figure:
    energies = style.series(tables["kernel-exact"], "epsilon", "ε")
    lines = (len(energies) + 1) // 2
    figure, panels = style.panels((960, 350 * lines), lines, 2, sharex=True, squeeze=False)
    for axes, (exact, colour, label) in zip(panels.flat, energies):
        energy = exact["epsilon"][0]
        seen = exact["density"] > 0
        axes.plot(exact["outgoing"][seen], exact["density"][seen], color=style.BLACK)
        if tables["kernel-measured"]:
            near = rows(tables["kernel-measured"], epsilon=energy)
            style.error_points(axes, near["outgoing"], *measured(near, "density"), colour)
        axes.set_ylim(0, _HIGHEST / (0.5 - min(energy, 0.49)))
        # Left or right of the curve that rises at 1/2 - epsilon.
        style.inside(axes, 0.35 if energy < 0.2 else 0.85, 0.9, label, ha="center")
    panels[0, 0].set_xlim(0, 0.5)
    figure.supxlabel("piston energy after, ε'")
    figure.supylabel("W(ε, ε')/f(ε)")
    style.remove_empty(panels, len(energies))
    return figure
