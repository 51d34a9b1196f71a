"""Relative entropies of first hits fall to their noise floor with delta (the paper's figure)

The relative entropy of the ingoing law of first hits with respect to the equilibrium law h^(1),
against delta, for four outgoing laws h^(n) and several energies of the piston, with one standard
error. Lines are noise floors: the mean for samples drawn from h^(1). Below epsilon = 1/4 the
histograms have twice as many bins, and the floor is twice as high.
Time on two cores: quick 3 s, default 1 min, full 10 min.
"""

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import ENERGIES, RHO, Client, Numbers, answer, divergences
from ballpiston.figures.parts.tables import Tables, distinct, measured, rows

EFFORT = {
    "quick": {"delta": "0.1:0.325:5:log", "samples": 30_000},
    "full": {"samples": 1_000_000},
}

_EXPONENTS = (0, 1, 5, 10)  # one panel each
_ASIDE = 1.025  # the points of successive energies are shifted in delta by this factor


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.0125:0.325:14:log",
    epsilon: Numbers = ENERGIES,
    samples: float = 100_000,
    seed: int = 0,
) -> Tables:
    """--full has the paper's number of samples. The noise floor falls as 1/samples."""
    question = {"rho": rho, "delta": delta, "epsilon": epsilon, "exponent": _EXPONENTS}
    result = answer(client, "first-hit", samples=samples, seed=seed, **question)
    return {"relative-entropy": divergences(result)}


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["relative-entropy"]
    count = len(distinct(data["epsilon"]))
    figure, panels = style.panels((960, 840), 2, 2, sharex=True)
    for axes, exponent in zip(panels.flat, _EXPONENTS):
        axes.set_xscale("log")
        axes.set_yscale("log")
        energies = style.series(rows(data, exponent=exponent), "epsilon", "ε")
        for k, (part, colour, label) in enumerate(energies):
            beside = part["delta"] * _ASIDE ** (k - (count - 1) / 2)
            dashed = {"linestyle": (0, (2, 2)), "linewidth": 1}
            axes.plot(part["delta"], part["noise_floor"], color=colour, **dashed)
            style.error_points(axes, beside, *measured(part), colour, label)
        axes.set_title(f"n = {exponent}")
        style.plain_log_ticks(axes.xaxis, (0.0125, 0.025, 0.05, 0.1, 0.2, 0.3))
    panels[0, 0].set_xlim(0.88 * data["delta"].min(), 1.14 * data["delta"].max())
    figure.supxlabel("δ")
    figure.supylabel("relative entropy")
    style.top_legend(figure, panels[0, 0].get_legend_handles_labels()[0])
    return figure
