"""In which variable x does the excess E(delta) of relative entropies oscillate?

The models are the power law E = A delta^b and E = A delta^b exp(c cos(omega x + phase)), with
x = delta, log(delta), 1/delta. The exponential function equals 1 + c cos(...) for small c, keeps E
positive, and makes log E linear in all parameters but omega. omega is scanned, for every x in the
same range: from 1.5 cycles over the data to one cycle in three points. The fit uses the points
whose excess is above 3 standard errors, without n = 1, which is the equilibrium law.

None of these models is exact. Therefore every log E has, beside its statistical error, a common
error `model_error`, which makes chi^2 of the best oscillating model equal to its degrees of
freedom. All models have the same errors, so that their chi^2 can be compared.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts.fits import linear
from ballpiston.figures.parts.tables import FloatArray, Table, distinct, groups, pick, table

# x = delta^-power; 0 is the logarithm.
_MODELS = {"delta": -1.0, "log(delta)": 0.0, "1/delta": 1.0}
_POWERS = -2 + np.arange(41) / 8
_LARGEST_ERROR = 4.0  # of log E
_FEWEST_POINTS = 10
_SEED = 20260101
_COLUMNS = (
    *("epsilon", "exponent", "points", "smallest_delta", "model_error", "model"),
    *("b", "b_error", "amplitude", "period", "chi_squared", "degrees_of_freedom", "gain"),
    *("false_alarm", "p_value", "transform", "transform_low", "transform_high"),
)


def fits(points: Table, synthetic: int) -> Table:
    """Every model beside the data of every series that has ten points above the noise.

    docs/research/markov-test.md explains `false_alarm` and `p_value`. Both are shares of
    `synthetic` data sets with a fixed seed: 0 means less than 1/synthetic. `transform` is the p for
    which x = delta^-p fits best. In rows with the exponent NaN, chi^2 is summed over the exponents,
    each with its own frequency and amplitude."""
    found: list[dict[str, Any]] = []
    random = np.random.default_rng(_SEED)
    for (epsilon, exponent), series in groups(points, "epsilon", "exponent"):
        above = series["excess"] > 3 * series["standard_error"]
        if exponent != 1 and above.sum() >= _FEWEST_POINTS:
            fitted = _fits_of_series(pick(series, above), random, synthetic)
            found += [{"epsilon": epsilon, "exponent": exponent} | row for row in fitted]
    return table(found + _sums(found), _COLUMNS)


def _fits_of_series(
    series: Table, random: np.random.Generator, synthetic: int
) -> list[dict[str, Any]]:
    """One row for the power law and for each oscillating model. `powers`: chi^2 of all powers."""
    x, y = np.log(series["delta"]), np.log(series["excess"])
    error = series["standard_error"] / series["excess"]
    scans = {name: _terms(x, power) for name, power in _MODELS.items()}
    model_error = _model_error([terms for terms, _ in scans.values()], y, error)
    error = np.hypot(error, model_error)

    def best_of(data: FloatArray) -> dict[str, Any]:
        """chi^2 of each model at its best frequency."""
        return {n: _chi_squared(terms, error, data).min(axis=-1) for n, (terms, _) in scans.items()}

    powers = np.array([_chi_squared(_terms(x, p)[0], error, y / error).min() for p in _POWERS])
    head = {"points": len(x), "smallest_delta": series["delta"].min(), "model_error": model_error}
    head |= {"powers": powers}
    power_law = next(iter(scans.values()))[0][:1, :, :2]
    plain = linear(power_law[0], y, error)
    law = {"model": "power law", "degrees_of_freedom": plain.freedom}
    found = [head | law | plain.row("A", "b")]
    noise = random.standard_normal((synthetic, len(x)))  # a fit removes the power law
    chi_of_noise, best_of_noise = _chi_squared(power_law, error, noise)[:, 0], best_of(noise)
    chi = best_of(y / error)
    for name, (terms, omegas) in scans.items():
        best = int(np.argmin(_chi_squared(terms, error, y / error)))
        fit = linear(terms[best], y, error)
        is_alarm = chi_of_noise / best_of_noise[name] >= plain.chi_squared / chi[name]
        model = terms[best] @ fit.coefficients / error
        again = best_of(model + random.standard_normal((synthetic, len(x))))
        worse = again[name] - np.min(list(again.values()), axis=0)
        row = {"model": name} | fit.row("A", "b")
        row |= {"amplitude": np.hypot(*fit.coefficients[2:]), "period": 2 * np.pi / omegas[best]}
        row |= {"chi_squared": chi[name], "gain": plain.chi_squared - chi[name]}
        row |= {"degrees_of_freedom": fit.freedom - 1}  # omega
        row |= {"false_alarm": is_alarm.mean()}
        row |= {"p_value": np.mean(worse >= chi[name] - min(chi.values()))}
        found.append(head | row | best_transform(powers))
    return found


def _terms(log_delta: FloatArray, power: float) -> tuple[FloatArray, FloatArray]:
    """The terms (frequencies, points, 4) of the model in delta^-power, and the frequencies."""
    x = log_delta if power == 0 else np.exp(-power * log_delta)
    most = len(x) / 3
    cycles = 1.5 + 0.15 * np.arange(1 + max(0, int(np.ceil((most - 1.5) / 0.15 - 1e-9))))
    omegas = 2 * np.pi * cycles / np.ptp(x)
    phases = np.outer(omegas, x)
    columns = np.broadcast_arrays(1.0, log_delta, np.cos(phases), np.sin(phases))
    return np.stack(columns, axis=-1), omegas


def _chi_squared(terms: FloatArray, error: FloatArray, data: FloatArray) -> FloatArray:
    """chi^2 (..., frequencies) of the best fits to data (..., points) that were divided by their
    errors."""
    basis, _ = np.linalg.qr(terms / error[:, np.newaxis])
    explained = np.sum(np.einsum("fpk,...p->...fk", basis, data) ** 2, axis=-1)
    chi: FloatArray = np.sum(data**2, axis=-1)[..., np.newaxis] - explained
    return chi


def _model_error(models: list[FloatArray], log_excess: FloatArray, error: FloatArray) -> float:
    """The common error with which chi^2 of the best model equals its degrees of freedom, by
    bisection."""

    def is_too_small(candidate: float) -> bool:
        total = np.hypot(error, candidate)
        chi = min(_chi_squared(terms, total, log_excess / total).min() for terms in models)
        return bool(chi > len(error) - 5)

    lower, upper = 0.0, _LARGEST_ERROR if is_too_small(0) else 0.0
    for _ in range(12 if upper > 0 else 0):
        middle = (lower + upper) / 2
        lower, upper = (middle, upper) if is_too_small(middle) else (lower, middle)
    return upper


def best_transform(chi_of_powers: FloatArray) -> dict[str, float]:
    """The power with the smallest chi^2, and the range of those that are at most 4 above."""
    near = _POWERS[chi_of_powers <= chi_of_powers.min() + 4]
    best = _POWERS[np.argmin(chi_of_powers)]
    return {"transform": best, "transform_low": near.min(), "transform_high": near.max()}


def _sums(fitted: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row for each energy and model: chi^2 and the counts, summed over the exponents."""
    found = []
    for epsilon, model in distinct((row["epsilon"], row["model"]) for row in fitted):
        same = [row for row in fitted if (row["epsilon"], row["model"]) == (epsilon, model)]
        names = {"points", "chi_squared", "degrees_of_freedom", "gain"} & same[0].keys()
        total = {name: sum(row[name] for row in same) for name in names}
        powers = np.sum([row["powers"] for row in same], axis=0)
        best = {} if model == "power law" else best_transform(powers)
        found.append({"epsilon": epsilon, "model": model} | total | best)
    return found
