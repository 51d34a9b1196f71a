"""Conditional collision rates collapse on one curve (the paper's figure of mean free times)

Conditional collision rates, measured at several delta and scaled by the mean free time, collapse
onto one curve, tau_bp/tau(epsilon) = phi(epsilon). Inset: the collision rate 1/tau_bp against
delta. Time on two cores: quick 1 s, default 2 s, full 3 min.
"""

from typing import Any

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer, number_list
from ballpiston.figures.parts.tables import Table, Tables, closed_forms, estimates, rows

EFFORT = {
    "quick": {"samples": 1000, "collisions": 10_000},
    "full": {"samples": 1_000_000, "collisions": 10_000_000},
}

# The paper's 59: 1/100, ..., 49/100, and 1/200, 1/400, ..., 1/3200 from both ends.
_ENERGIES = (
    "0.0003125,0.000625,0.00125,0.0025,0.005,0.01:0.49:49,0.495,0.4975,0.49875,0.499375,0.4996875"
)


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.2,0.1,0.05",
    samples: float = 10_000,
    collisions: float = 100_000,
    seed: int = 0,
) -> Tables:
    """Conditional mean free times from `samples` at each energy and delta (the paper has 10000),
    those of equilibrium from more collisions, which are correlated, and the exact curves: phi, the
    same at every delta, and tau_bp up to the largest delta."""
    # By default the server would answer with the closed forms that the figure tests.
    question = {"rho": rho, "delta": delta, "seed": seed, "model": "billiard"}
    conditional = answer(
        client, "conditional-mean-free-time", epsilon=_ENERGIES, samples=samples, **question
    )
    equilibrium = answer(client, "equilibrium", collisions=collisions, **question)
    bound = client.analytic(rho, 1e-9)["pair_delta_bound"][0]
    phi = client.analytic(rho, number_list("delta", delta)[0], "0:0.5:201")
    rate = client.analytic(rho, f"0.00001:{bound}:300:log")
    return {
        "mean-free-time": estimates(conditional),
        "mean-free-time-inset": estimates(equilibrium),
        "mean-free-time-phi": closed_forms(phi, "rho", "epsilon", "phi"),
        "mean-free-time-rate": closed_forms(rate, "rho", "delta", "tau_ball_piston"),
    }


@style.styled
def draw(tables: Tables) -> style.Figure:
    measured = rows(tables["mean-free-time"], name="mean_free_time_conditional")
    inset = rows(tables["mean-free-time-inset"], name="mean_free_time_ball_piston")
    figure = style.picture(960, 640)
    axes = figure.add_subplot()
    for part, colour, label in style.series(measured, "delta", "δ"):
        tau = rows(inset, delta=part["delta"][0])["exact"][0]
        _draw_rates(axes, part, "epsilon", tau, color=colour, label=label)
    phi = tables["mean-free-time-phi"]
    axes.plot(phi["epsilon"], phi["phi"], color=style.BLACK, label="exact φ$_{bp}$(ε)", zorder=3)
    axes.set(xlim=(0, 0.5), xlabel="piston energy ε", ylabel="τ$_{bp}$/τ(ε)")
    axes.legend(loc="lower right")
    _draw_inset(axes.inset_axes((0.13, 0.5, 0.38, 0.46)), inset, tables["mean-free-time-rate"])
    return figure


def _draw_rates(axes: Any, part: Table, x: str, unit: float, **style_of: Any) -> None:
    """Measured times as rates, in units of 1/unit."""
    rate = unit / part["value"]
    error = rate * part["standard_error"] / part["value"]
    style.error_points(axes, part[x], rate, error, **style_of)


def _draw_inset(axes: Any, inset: Table, exact: Table) -> None:
    axes.loglog(exact["delta"], 1 / exact["tau_ball_piston"], color=style.BLACK)
    for part, colour, _ in style.series(inset, "delta", "δ"):
        _draw_rates(axes, part, "delta", 1, color=colour, markersize=6)
    left, right = 0.7 * inset["delta"].min(), inset["delta"].max() / 0.7
    axes.set_xlim(left, right)
    seen = (exact["delta"] > left) & (exact["delta"] < right)
    rates = 1 / exact["tau_ball_piston"][seen]
    axes.set_ylim(rates.min(), rates.max())
    style.plain_log_ticks(axes.xaxis, (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3))
    axes.set(xlabel="δ", ylabel="1/τ$_{bp}$")
