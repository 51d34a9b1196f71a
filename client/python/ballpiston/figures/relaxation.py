"""Relaxation of the piston's energy: from given energies, and in equilibrium, beside the limit

Time is in units of the mean free time between ball-piston collisions. Points are means over orbits
of the billiard, with one standard error. Lines are the limit delta -> 0, from the spectrum of the
jump process.

a  mean energy of the piston from several start energies; it tends to 1/6
b  autocorrelation of the piston's energy in equilibrium
c  the difference of a from the limit, for the lowest and the highest start energy
d  the difference of b from the limit

Time on two cores: quick 2 s, default 25 s, full 4 min.
"""

from typing import Any

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer, in_mean_free_times
from ballpiston.figures.parts.tables import Table, Tables, curves, distinct, measured, rows

EFFORT = {"quick": {"samples": 20_000}, "full": {"samples": 2_000_000}}

_LEAST = 1e-5  # the axis of b begins here
_FROM_HIGHEST = 0.1  # in c: shift of the points of the highest start energy to the right


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.1,0.05",
    epsilon: Numbers = "0.01,0.125,0.375,0.49",
    samples: float = 200_000,
    seed: int = 0,
) -> Tables:
    """Mean energies from each start energy, and the autocorrelation of the energy in equilibrium,
    with the times `t` in units of the mean free time. `samples` are the orbits of each curve."""

    def relaxing(**start: Numbers) -> Table:
        question = {"rho": rho, "delta": delta, "model": "billiard", "samples": samples}
        result = answer(client, "energy-relaxation", seed=seed, **question, **start)
        return in_mean_free_times(client, curves(result))

    return {
        "relaxation-energy": relaxing(epsilon=epsilon),
        "relaxation-autocorrelation": relaxing(),
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    energy, correlation = tables["relaxation-energy"], tables["relaxation-autocorrelation"]
    deltas, starts = distinct(energy["delta"]), distinct(energy["epsilon"])
    lowest, highest = min(starts), max(starts)
    two_starts = f" (●), {highest:g} (△)" if highest > lowest else ""
    titles = (
        "mean energy of the piston",
        "autocorrelation of the energy",
        f"minus the limit: from {lowest:g}{two_starts}",
        "minus the limit",
    )
    figure, panels = style.panels((1080, 840), 2, 2, titles, sharex=True, height_ratios=(5, 3))
    for k, start in enumerate(starts):
        line = rows(energy, epsilon=start, delta=deltas[0])
        label = "limit δ → 0" if k == 0 else None
        panels[0, 0].plot(line["t"], line["limit"], color=style.BLACK, label=label)
    style.level(panels[0, 0], 1 / 6, color=style.GREY, linestyle=(0, (2, 2)))
    line = rows(correlation, delta=deltas[0])
    panels[0, 1].semilogy(line["t"], line["limit"], color=style.BLACK)
    for axes in panels[1]:
        style.level(axes, 0)
    for part, colour, label in style.series(energy, "delta", "δ"):
        dots: dict[str, Any] = {"color": colour, "markersize": 3}
        style.error_points(panels[0, 0], part["t"], *measured(part), label=label, **dots)
        _draw_excess(panels[1, 0], rows(part, epsilon=lowest), 0, **dots)
        if highest > lowest:
            triangles = dots | {"fmt": "^", "fillstyle": "none"}
            _draw_excess(panels[1, 0], rows(part, epsilon=highest), _FROM_HIGHEST, **triangles)
    for part, colour, _ in style.series(correlation, "delta", "δ"):
        dots = {"color": colour, "markersize": 3}
        style.error_points(panels[0, 1], part["t"], *measured(part), **dots)
        _draw_excess(panels[1, 1], part, 0, **dots)
    panels[0, 0].set(ylim=(0, 0.5), ylabel="mean energy", xlim=(0, 1.02 * energy["t"].max()))
    panels[0, 1].set(ylim=(_LEAST, 1.5), ylabel="autocorrelation")
    panels[0, 0].legend()
    for axes in panels[1]:
        axes.set(xlabel="t/τ$_{bp}$", ylabel="difference")
    return figure


def _draw_excess(axes: Any, part: Table, shift: float, **dots: Any) -> None:
    excess = measured(part, zero=part["limit"])
    style.error_points(axes, part["t"] + shift, *excess, **dots)
