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
from ballpiston.figures.parts.asking import RHO, Client, Numbers, answer
from ballpiston.figures.parts.asking import mean_free_times, number_list
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, pick, rows, table
from ballpiston.figures.parts.tangent_growth import second_exponent

EFFORT: dict[str, dict[str, Any]] = {
    "quick": {"delta": "0.3,0.05,0.03,0.02,0.015,0.01", "collisions": 1e4, "samples": 2**14},
    "full": {"collisions": 1e6, "samples": 2**20},
}

_FEWER_BELOW = 0.02  # collisions cost 1/delta^2; below this delta there are fewer of them
_FEWEST = 6400  # for which the server states errors
_RARE = 0.03  # fits are to this delta and below
_LIMIT = 1e-7  # a delta that stands for the limit
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
    """The exponents at each delta from `collisions`, in proportion to delta below 0.02; what is
    computed for lambda_2 from `samples` single collisions; and fits."""
    tau = mean_free_times(client, rho, delta)
    found = []
    for k, d in enumerate(number_list("delta", delta)):
        count = max(_FEWEST, collisions * min(1.0, d / _FEWER_BELOW))
        row = _exponents(client, rho, d, count, seed) | {"tau": tau[d]}
        found.append(row | second_exponent(rho, d, tau[d], samples, seed + 1 + k)._asdict())
    whole = table(found)
    return {
        "lyapunov": whole,
        "lyapunov-curve": _curve(client, rho, samples, seed),
        "lyapunov-fits": laws(whole),
    }


def _exponents(
    client: Client, rho: float, delta: float, collisions: float, seed: int
) -> dict[str, float]:
    question = {"rho": rho, "delta": delta, "model": "billiard", "seed": seed}
    aim = {"estimate": "lyapunov_2_per_collision", "collisions": round(collisions)}
    (point,) = answer(client, "lyapunov", **question, **aim)
    row = {"delta": delta, "samples": point.samples}
    for name, estimate in (("lambda_1", "lyapunov_1"), ("value", aim["estimate"])):
        of = point.estimates[str(estimate)]
        row |= {name: of.value, f"{name}_error": float(of.standard_error or np.nan)}
    return row


def _curve(client: Client, rho: float, samples: int, seed: int) -> Table:
    """The exponents up to delta = 0.3, or to the largest permitted delta if that is smaller. Every
    delta has the same random numbers, so the curve is smooth."""
    end = min(_CURVE_END, (1 - math.sqrt(4 * rho**2 - 1)) / 2)
    deltas = [d for d in number_list("delta", _CURVE.format(end=end)) if d <= end]
    found = []
    for delta, tau in mean_free_times(client, rho, deltas).items():
        growth = second_exponent(rho, delta, tau, samples, seed)
        found.append({"delta": delta, "tau": tau} | growth._asdict())
    return table(found)


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
    computed = {"values": rest, "errors": rest_error}
    measured = {"values": value, "errors": error}
    models: dict[str, dict[str, FloatArray]] = {
        "constant": {"terms": line[:, :1]} | measured,
        "power": {"terms": line, "values": np.log(value), "errors": error / value},
        "logarithm": {"terms": line} | measured,
        "logarithm and root": {"terms": with_root} | measured,
        "logarithm and computed terms": {"terms": line} | computed,
        "computed": {"terms": line[:, :0], "values": rest - log_tau, "errors": rest_error},
    }
    found = (
        {"law": name} | fits.linear(**model).row("A", "B")
        for name, model in models.items()
        if len(value) >= model["terms"].shape[1]
    )
    return table(found, ("law", "A", "A_error", "B", "B_error", "chi_squared", "freedom"))


@style.styled
def draw(tables: Tables) -> style.Figure:
    """Both panels."""
    figure, (left, right) = style.panels((960, 480), 1, 2, ("λ$_2$τ", "λ$_2$τ - ln τ"))
    found, curve = tables["lyapunov"], tables["lyapunov-curve"]
    (limit,) = _above_logarithm(rows(curve, delta=_LIMIT), "computed")
    _draw_growth(left, found, curve, limit)
    root = np.sqrt(curve["delta"])
    right.plot(root, _above_logarithm(curve, "computed"), color=style.BLACK, label="computed")
    plain = _above_logarithm(curve, "long_waits")
    right.plot(root, plain, "--", color=style.GREY, label="computed, long waits")
    style.level(right, limit, linestyle=":")
    value = _above_logarithm(found, "value")
    style.error_points(right, np.sqrt(found["delta"]), value, found["value_error"], style.BLUE)
    right.set(xlabel="√δ")
    right.legend()
    return figure


def _above_logarithm(part: Table, name: str) -> FloatArray:
    above: FloatArray = part[name] - np.log(part["tau"])
    return above


def _draw_growth(axes: Any, found: Table, curve: Table, limit: float) -> None:
    tau = np.geomspace(found["tau"].min() / 2, found["tau"].max() * 2, 100)
    axes.plot(tau, np.log(tau) + limit, ":", color=style.BLACK, label=f"ln τ + {limit:.3f}")
    shown = pick(curve, curve["tau"] < tau[-1])
    axes.plot(shown["tau"], shown["computed"], color=style.BLACK, label="computed")
    measured = found["tau"], found["value"], found["value_error"]
    style.error_points(axes, *measured, style.BLUE, "billiard")
    axes.set_xscale("log")
    axes.set(xlabel="mean free time τ", xlim=(tau[0], tau[-1]))
    axes.legend(loc="upper left")
