"""Times to the first ball-piston collision in equilibrium, beside the exponential law

One column for each energy of the piston. Above: the probability that ball and piston have not
collided up to the time t after a collision, for several delta, and the exponential law (black).
Below: the difference from the exponential law, with one standard error. Time is in units of the
conditional mean free time, so that the exponential law is exp(-t). All points of a line come from
the same hits: neighbouring points have nearly the same statistical error. The lines have steps,
because the piston reaches the cell once in its period (2 lambda + 4 delta)/u.
Time on two cores: quick 1 s, default 25 s, full 8 min.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer
from ballpiston.figures.parts.tables import Tables, closed_forms, curves, distinct, rows

EFFORT = {
    "quick": {"delta": "0.325,0.2,0.1,0.05", "samples": 30_000},
    "full": {"samples": 20_000_000},
}

_LEAST = 2e-4  # the upper axis ends here


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.325,0.2,0.1,0.05,0.0125",
    epsilon: Numbers = "0.03125,0.25,0.46875",
    exponent: Numbers = 1,
    samples: float = 1_000_000,
    seed: int = 0,
) -> Tables:
    """The curves `survival`, where `t` is the time in units of the conditional mean free time. At
    energies other than 0 and 1/2 their limit is the exponential law."""
    question = {"rho": rho, "delta": delta, "epsilon": epsilon, "exponent": exponent}
    result = answer(client, "first-hit", samples=samples, seed=seed, **question)
    survival = curves(result, "survival")
    forms = client.analytic(rho, delta, epsilon)
    units = closed_forms(forms, "delta", "epsilon", "mean_free_time_conditional")
    unit_of = {(d, e): unit for d, e, unit in zip(*units.values())}
    pairs = zip(survival["delta"], survival["epsilon"])
    survival["t"] = survival["time"] / np.array([unit_of[pair] for pair in pairs])
    # Where the server states no error, the error is binomial, with the larger of the measured and
    # the exponential probability, and half a count more, as in the server's errors.
    count = survival["samples"]
    p = (count * np.fmax(survival["value"], survival["limit"]) + 0.5) / (count + 1)
    binomial = np.sqrt(p * (1 - p) / count)
    error = survival["standard_error"]
    survival["error"] = np.where(np.isfinite(error), error, binomial)
    return {"hitting-time": survival}


@style.styled
def draw(tables: Tables) -> style.Figure:
    """Of several exponents only the first one."""
    data = tables["hitting-time"]
    data = rows(data, exponent=data["exponent"][0])
    energies = distinct(data["epsilon"])
    width = max(640, 100 + 320 * len(energies))
    figure, panels = style.panels((width, 760), 2, len(energies), **style.SHARED)
    longest = data["t"].max()
    t = np.linspace(0, longest, 200)
    exponential: dict[str, Any] = {"color": style.BLACK, "linewidth": 1.2, "dashes": (6, 4)}
    for (upper, lower), epsilon in zip(panels.T, energies):
        upper.set_title(f"ε = {epsilon:g}")
        for line, colour, label in style.series(rows(data, epsilon=epsilon), "delta", "δ"):
            seen = line["value"] > 0
            upper.semilogy(line["t"][seen], line["value"][seen], color=colour, label=label)
            excess = line["value"] - np.exp(-line["t"])
            style.error_points(lower, line["t"], excess, line["error"], colour, markersize=2)
        upper.semilogy(t, np.exp(-t), label="exponential", **exponential)
        style.level(lower, 0, **exponential)
    # No standard error of a probability is larger.
    style.signed_log_axis(panels[1, 0], 1 / np.sqrt(data["samples"][0]))
    panels[0, 0].set(ylim=(_LEAST, 1.3), ylabel="probability of no collision yet")
    panels[1, 0].set(xlim=(0, 1.01 * longest), ylabel="minus the exponential")
    figure.supxlabel("t/τ$_{bp}$(ε)")
    style.top_legend(figure, panels[0, 0].get_legend_handles_labels()[0])
    return figure
