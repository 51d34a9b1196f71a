"""The generator's spectrum of relaxation rates, and energy autocorrelations of the billiard

Above: the relaxation rates of the jump process. Isolated rates (lines) accumulate at the bottom of
a continuum, which consists of the values of the total rate f(epsilon) of jumps. Rates above the
continuum are not drawn. Below: the autocorrelation of the piston's energy, measured in the
billiard, and its limit for rare collisions, which finally decays at the smallest rate. The
billiard's tail comes from slow pistons. By default it takes half a minute of two cores.
"""

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer
from ballpiston.figures.parts.asking import in_mean_free_times, number_list
from ballpiston.figures.parts.tables import Table, Tables, closed_forms, curves, estimates, measured

EFFORT = {"quick": {"samples": 20_000}, "full": {"samples": 20_000_000}}

_LOWEST = 5e-4  # the smallest correlation on the axis
_LABELLED = 3  # number of isolated rates with a label; the next rates are too close


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.3,0.2,0.1",
    samples: float = 500_000,
    seed: int = 0,
) -> Tables:
    """`samples` are the orbits of each autocorrelation."""
    one_delta = number_list("delta", delta)[0]
    spectrum = answer(client, "energy-relaxation", rho=rho, delta=one_delta, model="spectrum")
    question = {"rho": rho, "delta": delta, "samples": samples, "seed": seed}
    billiard = answer(client, "energy-relaxation", model="billiard", **question)
    forms = client.analytic(rho, one_delta, "0:0.5:201")
    facts = ("rho", "delta", "volume", "area_ball_piston", "tau_ball_piston", "epsilon", "f")
    return {
        "spectrum": estimates(spectrum),
        "spectrum-rate": closed_forms(forms, *facts),
        "spectrum-billiard": in_mean_free_times(client, curves(billiard)),
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    figure, (upper, lower) = style.panels((960, 900), 2, 1, height_ratios=(3, 4))
    _draw_rates(upper, tables["spectrum"], tables["spectrum-rate"])
    several = style.series(tables["spectrum-billiard"], "delta", "δ")
    line, *_ = several[0]
    lower.semilogy(line["t"], line["limit"], color=style.BLACK, label="limit δ → 0")
    for part, colour, label in several:
        style.error_points(lower, part["t"], *measured(part), colour, label)
    lower.set(ylim=(_LOWEST, 1.3), xlabel="t/τ$_{bp}$", ylabel="energy autocorrelation")
    lower.set_xlim(0, line["t"].max())
    lower.legend(loc="upper right")
    return figure


def _draw_rates(axes: style.Axes, spectrum: Table, total: Table) -> None:
    isolated = spectrum["value"][spectrum["name"] != "relaxation_time"]
    bottom, top = total["f"].min(), total["f"].max()
    axes.axvspan(bottom, top, color=style.REACH)
    axes.plot(total["f"], total["epsilon"], color=style.BLUE, linewidth=2)
    axes.axvline(0, color=style.ORANGE, linewidth=5)
    for k, rate in enumerate(isolated):
        axes.axvline(rate, color=style.ORANGE, linewidth=1.5)
        if k < _LABELLED:
            beside = {"rotation": 90, "ha": "right", "va": "bottom", "fontsize": 10}
            axes.text(rate, 0.02, f"{rate:.4f}", color=style.ORANGE, **beside)
    axes.text((bottom + top) / 2, 0.45, "continuum", ha="center")
    axes.text(0.97 * top, 0.4, "f(ε)", ha="right")
    axes.text(0.92 * isolated[0], 0.45, "isolated rates", ha="right")
    axes.text(0.02 * top, 0.25, "equilibrium", rotation=90, va="center")
    axes.set(xlim=(0, 1.04 * top), ylim=(0, 0.5), ylabel="piston energy ε")
    axes.set_xlabel("rate / (|∂Γ$_{bp}$|/|Γ|)")
    axes.tick_params(axis="x", top=False)
    per_tau = float(total["tau_ball_piston"][0] * (total["area_ball_piston"] / total["volume"])[0])
    above = axes.secondary_xaxis("top", functions=(lambda x: x * per_tau, lambda x: x / per_tau))
    above.set_xlabel("rate × τ$_{bp}$")
