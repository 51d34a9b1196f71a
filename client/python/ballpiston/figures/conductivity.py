"""Conductivities of gases over the static one: against delta, and of rare exchanges against 1/N

The Green-Kubo conductivity, divided by the static conductivity (half of the exchange rate), with
one standard error; a hollow point has no known error. Left: the billiard against delta. Right:
rings of N cells in the limit of rare exchanges, against 1/N. The line is the value of the infinite
gas, from Varadhan's formula.
Time on two cores: quick 3 s, default 50 s, full 5 min.
"""

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, Shapes
from ballpiston.figures.parts.asking import answer, check_chains, number_list
from ballpiston.figures.parts.tables import Table, Tables, estimates, measured, rows

EFFORT = {
    "quick": {"billiard_samples": 3000, "samples": 1000},
    "full": {"billiard_samples": 300_000},
}


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.05,0.1,0.15,0.2",
    billiard_cells: Shapes = 4,
    cells: Shapes = "2,3,4,6,8,16,32",
    billiard_samples: float = 50_000,
    samples: float = 5000,
    seed: int = 0,
) -> Tables:
    """Estimates of the billiard at each delta, in a ring of `billiard_cells`, and of the jump
    process, the limit delta -> 0, in each ring of `cells`. Samples are replicas of a ring."""
    check_chains(cells)

    def gas(model: str, delta: Numbers, cells: Shapes, samples: float) -> Table:
        question = {"rho": rho, "delta": delta, "cells": cells, "temperature": 1, "seed": seed}
        question |= {"model": model, "samples": samples, "estimate": "conductivity"}
        return estimates(answer(client, "gas-equilibrium", **question))

    return {
        "conductivity-billiard": gas("billiard", delta, billiard_cells, billiard_samples),
        # The correction of the limit depends neither on rho nor on delta.
        "conductivity-rings": gas("markov", number_list("delta", delta)[0], cells, samples),
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    billiard = rows(tables["conductivity-billiard"], name="conductivity_ratio")
    rings = rows(tables["conductivity-rings"], name="conductivity_ratio")
    limit = rings["limit"][0]
    figure, (left, right) = style.panels((960, 500), 1, 2)
    style.level(left, limit, color=style.ORANGE, label="rare exchanges")
    style.error_points(left, billiard["delta"], *measured(billiard), style.BLUE, "billiard")
    left.set(xlabel="δ", ylabel="conductivity / static value")
    infinite = 1000 * (limit - 1)
    style.level(right, infinite, color=style.ORANGE, label=f"infinite: {infinite:.4f}")
    share = 1 / rings["cells"].astype(float)
    excess = measured(rings, zero=1, unit=0.001)
    style.error_points(right, share, *excess, style.BLUE, "jump process, rings of N cells")
    right.set(xlabel="1/N", ylabel="1000 (conductivity / static value - 1)")
    for axes in (left, right):
        axes.set_xlim(0, axes.dataLim.xmax * 1.06)
        axes.margins(y=0.25)
        axes.legend(loc="upper left")
    return figure
