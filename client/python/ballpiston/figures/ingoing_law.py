"""Angles of first hits beside their equilibrium law, at several delta (the paper's histograms)

Densities of the ingoing angle alpha of first hits that start from the outgoing law h^(n), for both
directions sigma of the piston, and the equilibrium law h^(1) (filled). One row for each energy of
the piston, one column for each delta. The band of a line is one standard error. The density of
sigma = +1 is zero if the piston is faster than the ball, epsilon >= 1/4.
Time on two cores: quick 1 s, default 10 s, full 1 min.
"""

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import ENERGIES, RHO, Client, Numbers, answer
from ballpiston.figures.parts.tables import Table, Tables, distinct, groups
from ballpiston.figures.parts.tables import histograms, rows, stacked

EFFORT = {
    "quick": {"samples": 20_000, "merged": 40},
    "full": {"samples": 1_000_000, "merged": 10},
}

_SIGNS = ((-1, "−", style.ORANGE), (1, "+", style.BLUE))


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.325,0.175,0.0125",
    epsilon: Numbers = ENERGIES,
    exponent: Numbers = 0,
    samples: float = 300_000,
    seed: int = 0,
    merged: int = 20,
) -> Tables:
    """Histograms with wider bins: `merged` of the server's 1000 bins are one bin of the picture.
    Fewer samples need wider bins; otherwise the noise hides the deviation."""
    question = {"rho": rho, "delta": delta, "epsilon": epsilon, "exponent": exponent}
    result = answer(client, "first-hit", samples=samples, seed=seed, **question)
    return {"ingoing-law": merge(rows(histograms(result), name="alpha"), merged)}


def merge(bins: Table, merged: int) -> Table:
    """Histograms with `merged` neighbouring bins in one. Densities are means over a bin; `error` is
    the standard error; that of an empty bin is the error of the count expected from h^(1)."""
    keys = ("delta", "epsilon", "exponent", "sigma")
    found = []
    for values, part in groups(bins, *keys):
        starts = np.arange(0, len(part["lower"]), merged)
        ends = np.append(starts[1:], len(part["lower"])) - 1
        sizes = ends - starts + 1
        lower, upper = part["lower"][starts], part["upper"][ends]
        counts, density, exact = (
            np.add.reduceat(part[name], starts) for name in ("count", "density", "exact_density")
        )
        exact /= sizes
        total = part["samples"][0] * (upper - lower)  # the count at the density 1
        error = np.sqrt(np.where(counts > 0, counts, exact * total)) / total
        row = dict(zip(keys, values)) | {"alpha": (lower + upper) / 2, "density": density / sizes}
        found.append(row | {"error": error, "exact_density": exact})
    return stacked(found)


@style.styled
def draw(tables: Tables) -> style.Figure:
    """Of several exponents only the first one."""
    data = tables["ingoing-law"]
    data = rows(data, exponent=data["exponent"][0])
    deltas, energies = distinct(data["delta"]), distinct(data["epsilon"])
    size = 760 if len(deltas) < 3 else 300 * len(deltas) + 60, 210 * len(energies) + 120
    figure, panels = style.panels(size, len(energies), len(deltas), **style.SHARED)
    for row, epsilon in zip(panels, energies):
        for axes, delta in zip(row, deltas):
            for sigma, sign, colour in _SIGNS:
                law = rows(data, delta=delta, epsilon=epsilon, sigma=sigma)
                x, density, exact = law["alpha"], law["density"], law["exact_density"]
                low, high = density - law["error"], density + law["error"]
                label = f"σ = {sign}1"
                area = {"color": colour, "linewidth": 0}
                axes.plot(x, density, color=colour, linewidth=1.2, label=label)
                axes.fill_between(x, exact, alpha=0.25, label=f"h$^{{(1)}}$, {label}", **area)
                axes.fill_between(x, low, high, alpha=0.35, **area)
        row[0].set_ylim(0, None)
        style.inside(row[0], 0.04, 0.88, f"ε = {epsilon:g}")
    for axes, delta in zip(panels[0], deltas):
        axes.set_title(f"δ = {delta:g}", loc="center")
    panels[0, 0].set_xlim(-np.pi, np.pi)
    panels[0, 0].set_xticks([-np.pi / 2, 0, np.pi / 2], ["−π/2", "0", "π/2"])
    figure.supxlabel("angle α")
    figure.supylabel("density")
    style.top_legend(figure, panels[0, 0].get_legend_handles_labels()[0])
    return figure
