"""Temperatures along chains between a hot and a cold reservoir, and the linear law of T^(3/2)

Temperatures of balls and pistons along chains of N cells between two reservoirs, against x/N, from
the jump process (the limit delta -> 0) and from the billiard. If the conductivity grows as sqrt(T),
T^(3/2) falls linearly. Lower panel: the difference from that line.
Time on two cores: quick 2 s, default 50 s, full 15 min.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Shapes, answer, check_chains
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, curves
from ballpiston.figures.parts.tables import distinct, measured, pick, rows

EFFORT = {
    "quick": {"cells": "2,4,8", "samples": 4000, "billiard_samples": 500},
    "full": {"samples": 500_000, "billiard_samples": 50_000},
}

_ASIDE = 0.007  # shift of the billiard's points to the right, so that all points are visible
_DARK = "#606060"
_BODIES: list[tuple[str, str, str, dict[str, Any]]] = [  # model, body, label, marker
    (model, body, f"{body}, {name}", {"marker": marker, "fillstyle": fill, "markersize": 5})
    for model, name, fill in (("markov", "δ → 0", "full"), ("billiard", "billiard", "none"))
    for body, marker in (("balls", "o"), ("pistons", "s"))
]


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.1,
    cells: Shapes = "4,8,16",
    hot: float = 1.5,
    cold: float = 0.5,
    samples: float = 20_000,
    billiard_samples: float = 2000,
    seed: int = 0,
) -> Tables:
    """The profiles of both models, from stretches of chains of `cells`. The billiard costs about
    fifty times as much as the jump process."""

    def profile(model: str, samples: float) -> Table:
        check_chains(cells)
        question = {"rho": rho, "delta": delta, "cells": cells, "hot": hot, "cold": cold}
        question |= {"model": model, "samples": samples, "seed": seed}
        return curves(answer(client, "gas-conduction", **question), "temperature_profile")

    return {
        "temperature-profile-markov": profile("markov", samples),
        "temperature-profile-billiard": profile("billiard", billiard_samples),
    }


def linear_law(hot: float, cold: float, x: FloatArray) -> FloatArray:
    """The temperature at the share x of the chain if T^(3/2) is linear."""
    law: FloatArray = (hot**1.5 + (cold**1.5 - hot**1.5) * x) ** (2 / 3)
    return law


@style.styled
def draw(tables: Tables) -> style.Figure:
    markov = tables["temperature-profile-markov"]
    hot, cold = float(markov["hot"][0]), float(markov["cold"][0])
    lengths = distinct(markov["cells"])
    figure, panels = style.panels((960, 840), 2, 1, sharex=True, height_ratios=(3, 2))
    x = np.linspace(0, 1, 200)
    line = {"color": style.BLACK, "label": "linear T$^{3/2}$"}
    handles = panels[0].plot(x, linear_law(hot, cold, x), **line)
    style.level(panels[1], 0)
    for k, length in enumerate(lengths):
        colour = style.colour(k)
        handles.append(style.point_handle(f"N = {length}", colour))
        for model, body, _, marker in _BODIES:
            part = rows(tables[f"temperature-profile-{model}"], cells=length)
            has_whole_position = part["position"] == np.floor(part["position"])  # as pistons have
            part = pick(part, has_whole_position == (body == "pistons"))
            share = part["position"] / part["cells"].astype(float)
            place = share + (_ASIDE if model == "billiard" else 0)
            panels[0].plot(place, part["value"], linestyle="", color=colour, **marker)
            excess = measured(part, zero=linear_law(hot, cold, share))
            style.error_points(panels[1], place, *excess, colour, fmt="", linestyle="", **marker)
    handles += [style.point_handle(label, _DARK, **marker) for *_, label, marker in _BODIES]
    panels[0].set_ylabel("temperature T")
    panels[1].set(xlim=(-0.02, 1.03), xlabel="x/N", ylabel="T minus the line")
    panels[0].legend(handles=handles)
    return figure
