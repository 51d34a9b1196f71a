"""Laws of the piston's energy at six times after a start at one energy, beside the master equation

Densities of the piston's energy at several times after a start at one energy: from the billiard and
the sampled jump process (points), and from the master equation (black steps). Below each panel: the
ratio to the master equation, with one standard error. Two rows of panels for each start energy. The
peak is the bin of the start energy: it contains the orbits without an exchange. Its share of all
orbits, from the master equation, is above the panel.
Time on two cores: quick 1 s, default 10 s, full 2 min.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer
from ballpiston.figures.parts.asking import in_mean_free_times, number_list
from ballpiston.figures.parts.tables import Table, Tables, groups, histograms, rows, stacked

EFFORT = {"quick": {"samples": 20_000}, "full": {"samples": 10_000_000}}

_ACROSS = 3
_RATIOS = (0.5, 1.5)


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.05",
    epsilon: Numbers = 0.0625,
    samples: float = 1_000_000,
    seed: int = 0,
) -> Tables:
    """All laws, with times in units of the mean free time. `samples` are the orbits of each delta,
    and of the jump process."""

    def law(model: str, delta: Numbers) -> Table:
        question = {"rho": rho, "epsilon": epsilon, "model": model, "delta": delta}
        question |= {"samples": samples, "seed": seed}
        result = answer(client, "energy-relaxation", **question)
        return beside_exact(
            in_mean_free_times(client, rows(histograms(result), name="piston_energy"))
        )

    # In units of the mean free time, the times and the law of the jump process are the same at
    # every delta.
    jumps = law("markov", number_list("delta", delta)[0])
    return {"master-equation": stacked([law("billiard", delta), jumps])}


def beside_exact(bins: Table) -> Table:
    """Densities with their binomial error, and their ratios to the master equation. A bin without
    an orbit has the binomial error of the exact law."""
    width = bins["upper"] - bins["lower"]
    exact, density, samples = bins["exact_density"], bins["density"], bins["samples"]
    share = np.where(bins["count"] > 0, bins["count"] / samples, exact * width)
    error = np.sqrt(share * (1 - share) / samples) / width
    return {name: bins[name] for name in ("model", "delta", "epsilon")} | {
        "time": np.array([float(f"{t:.3g}") for t in bins["t"]]),
        "lower": bins["lower"],
        "upper": bins["upper"],
        "density": density,
        "error": error,
        "exact": exact,
        "ratio": density / exact,
        "ratio_error": error / exact,
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["master-equation"]
    cases = list(groups(data, "epsilon", "time"))
    blocks = [cases[k : k + _ACROSS] for k in range(0, len(cases), _ACROSS)]
    size = 360 * _ACROSS + 90, 350 * len(blocks) + 60
    shared: dict[str, Any] = style.SHARED | {"height_ratios": (2, 1) * len(blocks)}
    figure, panels = style.panels(size, 2 * len(blocks), _ACROSS, **shared)
    for k, block in enumerate(blocks):
        for upper, lower, ((start, time), law) in zip(panels[2 * k], panels[2 * k + 1], block):
            _draw_law(upper, lower, law)
            (_, first), *_ = groups(law, "model", "delta")
            there = np.searchsorted(first["lower"], start, "right") - 1  # the start's bin
            peak = 100 * (first["exact"] * (first["upper"] - first["lower"]))[there]
            upper.set_title(
                f"t = {time:g} τ$_{{bp}}$   (bin of ε = {start:g}: {peak:.3g} %)", fontsize=11
            )
        panels[2 * k, 0].set_ylabel("density")
        panels[2 * k + 1, 0].set(ylim=_RATIOS, ylabel="ratio")
    panels[0, 0].set_xlim(0, 0.5)
    for axes in panels[-1]:
        axes.set_xlabel("energy of the piston ε")
    handles, _ = panels[0, 0].get_legend_handles_labels()
    style.top_legend(figure, handles, markerscale=2)
    return figure


def _draw_law(upper: Any, lower: Any, law: Table) -> None:
    """The points of the series are side by side in their bin."""
    series = list(groups(law, "model", "delta"))
    for k, ((model, delta), part) in enumerate(series):
        place = part["lower"] + (k + 0.5) / len(series) * (part["upper"] - part["lower"])
        seen = part["density"] > 0
        dots: dict[str, Any] = {"color": style.colour(k), "markersize": 2}
        label = "jump process" if model == "markov" else f"δ = {delta:g}"
        upper.semilogy(place[seen], part["density"][seen], "o", label=label, **dots)
        style.error_points(lower, place, part["ratio"], part["ratio_error"], **dots)
    edges = [*part["lower"], part["upper"][-1]]
    exact: dict[str, Any] = {"color": style.BLACK, "linewidth": 1, "label": "master equation"}
    upper.stairs(part["exact"], edges, baseline=None, **exact)
    style.level(lower, 1)
