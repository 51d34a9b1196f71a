"""The second Lyapunov exponent at rare collisions: lambda_2 in a collision grows as log(tau)

The pair has the Lyapunov exponents lambda_1 > lambda_2 > 0. The second one vanishes with the rate
of ball-piston collisions, but lambda_2 tau does not tend to a constant. parts/tangent_growth.py
computes it from the statistics of one collision, without a fit.

a  lambda_2 in a collision over the mean free time tau, and its law for delta -> 0
b  the same less log(tau), over the root of delta

Time on one core: quick 12 s, default 70 s, full 11 min.
"""

import math
from typing import Any

import numpy as np

from ballpiston.figures.parts import fits, style
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer, number_list
from ballpiston.figures.parts.tables import Table, Tables, measured, pick, table
from ballpiston.figures.parts.tangent_growth import second_exponent

EFFORT = {
    "quick": {"delta": "0.3,0.05,0.03,0.02,0.015,0.01", "collisions": 1e4, "samples": 2**14},
    "full": {"collisions": 1e6, "samples": 2**20},
}

_FEWER_BELOW = 0.02  # collisions cost 1/delta^2; below this delta there are fewer of them
_FEWEST = 6400  # for which the server states errors
_RARE = 0.03  # fits are to this delta and below
# The first delta stands for the limit.
_CURVE = "0.0000001,0.000001,0.00001:0.001:9:log,0.0014:{end!r}:30:log"
_CURVE_END = 0.3


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: Numbers = "0.3,0.2,0.1,0.05,0.03,0.02,0.01,0.005,0.003",
    collisions: float = 1e5,
    samples: int = 2**16,
    seed: int = 0,
) -> Tables:
    """The exponents at each delta, from `collisions` collisions (below delta = 0.02: fewer, in
    proportion to delta). lambda_2 as computed from `samples` single collisions. Fits."""
    second = "lyapunov_2_per_collision"
    question: dict[str, Any] = {"rho": rho, "model": "billiard", "seed": seed, "estimate": second}
    forms = client.analytic(rho, delta)
    found = []
    for k, (d, tau) in enumerate(zip(forms["delta"].tolist(), forms["tau_ball_piston"].tolist())):
        count = round(max(_FEWEST, collisions * min(1.0, d / _FEWER_BELOW)))
        (point,) = answer(client, "lyapunov", delta=d, collisions=count, **question)
        row: dict[str, Any] = {"delta": d, "samples": point.samples}
        for name, estimate in (("lambda_1", "lyapunov_1"), ("value", second)):
            row |= {name: point[estimate], f"{name}_error": point.error(estimate)}
        found.append(row | {"tau": tau} | second_exponent(rho, d, tau, samples, seed + 1 + k))
    whole = table(found)
    return {
        "lyapunov": whole,
        "lyapunov-curve": _curve(client, rho, samples, seed),
        "lyapunov-fits": laws(whole),
    }


def _curve(client: Client, rho: float, samples: int, seed: int) -> Table:
    """The exponents up to delta = 0.3, or to the largest permitted delta if that is smaller. Every
    delta has the same random numbers, so the curve is smooth."""
    end = min(_CURVE_END, (1 - math.sqrt(4 * rho**2 - 1)) / 2)
    deltas = [d for d in number_list("delta", _CURVE.format(end=end)) if d <= end]
    times = client.analytic(rho, deltas)["tau_ball_piston"].tolist()
    return table(
        {"delta": delta, "tau": tau} | second_exponent(rho, delta, tau, samples, seed)
        for delta, tau in zip(deltas, times)
    )


def laws(whole: Table) -> Table:
    """Fits to delta <= 0.03 of `value`: by A; by A tau^B; by A + B log(tau); by the same and a term
    sqrt(delta); of what remains of `value` without the computed terms, by A + B log(tau); and
    `computed` itself, without a coefficient. Fits to fewer points than coefficients are left
    out."""
    rare = pick(whole, whole["delta"] <= _RARE)
    value, error, log_tau = rare["value"], rare["value_error"], np.log(rare["tau"])
    line = np.column_stack([np.ones(len(value)), log_tau])
    with_root = np.column_stack([line, np.sqrt(rare["delta"])])
    rest = value - (rare["computed"] - log_tau)
    rest_error = np.hypot(error, rare["computed_error"])
    models = {
        "constant": (line[:, :1], value, error),
        "power": (line, np.log(value), error / value),
        "logarithm": (line, value, error),
        "logarithm and root": (with_root, value, error),
        "logarithm and computed terms": (line, rest, rest_error),
        "computed": (line[:, :0], rest - log_tau, rest_error),
    }
    found = (
        {"law": name} | fits.linear(terms, *values).row("A", "B")
        for name, (terms, *values) in models.items()
        if len(value) >= terms.shape[1]
    )
    return table(found, ("law", "A", "A_error", "B", "B_error", "chi_squared", "freedom"))


@style.styled
def draw(tables: Tables) -> style.Figure:
    figure, (left, right) = style.panels((960, 480), 1, 2, ("λ$_2$τ", "λ$_2$τ - ln τ"))
    found, curve = tables["lyapunov"], tables["lyapunov-curve"]
    root, logarithm = np.sqrt(curve["delta"]), np.log(curve["tau"])
    computed, long_waits = curve["computed"] - logarithm, curve["long_waits"] - logarithm
    tau = np.geomspace(found["tau"].min() / 2, found["tau"].max() * 2, 100)
    law = f"ln τ + {computed[0]:.3f}"
    left.plot(tau, np.log(tau) + computed[0], ":", color=style.BLACK, label=law)
    shown = pick(curve, curve["tau"] < tau[-1])
    left.plot(shown["tau"], shown["computed"], color=style.BLACK, label="computed")
    style.error_points(left, found["tau"], *measured(found), style.BLUE, "billiard")
    left.set(xscale="log", xlabel="mean free time τ", xlim=(tau[0], tau[-1]))
    left.legend(loc="upper left")
    right.plot(root, computed, color=style.BLACK, label="computed")
    right.plot(root, long_waits, "--", color=style.GREY, label="computed, long waits")
    style.level(right, computed[0], linestyle=":")
    values = measured(found, zero=np.log(found["tau"]))
    style.error_points(right, np.sqrt(found["delta"]), *values, style.BLUE)
    right.set(xlabel="√δ")
    right.legend()
    return figure
