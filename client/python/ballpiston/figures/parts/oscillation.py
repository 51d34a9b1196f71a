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

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ballpiston.figures.parts.fits import linear
from ballpiston.figures.parts.tables import FloatArray, Table, distinct, pick, rows, table

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


def series_of(points: Table) -> Iterator[tuple[tuple[float, float], Table]]:
    """The points of each (epsilon, exponent)."""
    for epsilon, exponent in distinct(zip(points["epsilon"], points["exponent"])):
        yield (epsilon, exponent), rows(points, epsilon=epsilon, exponent=exponent)


def fits(points: Table, synthetic: int) -> Table:
    """Every model beside the data of every series that has ten points above the noise.

    false_alarm  probability that the scan finds as large a relative gain in chi^2 in data of the
                 plain power law
    p_value      probability that this model, if it is true, fits worse than the best model by as
                 much as here
    transform    the p for which x = delta^-p fits best (p = 0 is the logarithm), with the range of
                 all p whose chi^2 is at most 4 larger

    Both probabilities are shares of `synthetic` data sets with a fixed seed: 0 means less than
    1/synthetic. In rows with the exponent NaN, chi^2 is summed over the exponents, each with its
    own frequency and amplitude."""
    found: list[dict[str, Any]] = []
    of_energy: dict[float, list[SeriesFit]] = {}
    random = np.random.default_rng(_SEED)
    for (epsilon, exponent), series in series_of(points):
        above = series["excess"] > 3 * series["standard_error"]
        if exponent == 1 or above.sum() < _FEWEST_POINTS:
            continue
        chosen = pick(series, above)
        fit = SeriesFit.of(chosen)
        of_energy.setdefault(epsilon, []).append(fit)
        head = {"epsilon": epsilon, "exponent": exponent, "points": len(fit.log_delta)}
        head |= {"smallest_delta": chosen["delta"].min(), "model_error": fit.model_error}
        found += [head | row for row in fit.rows(random, synthetic)]
    for epsilon, several in of_energy.items():
        found += [{"epsilon": epsilon} | row for row in _sums(several)]
    return table(found, _COLUMNS)


@dataclass(frozen=True)
class Basis:
    """Orthonormal pairs of an oscillation in one variable, one pair for each frequency, orthogonal
    to the power law, for data that were divided by their errors."""

    power: float
    waves: FloatArray  # (frequencies, points, 2)
    omegas: FloatArray

    def amplitudes(self, whitened: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The components (..., 2) of data (..., points) at the best frequency, and its index."""
        components: FloatArray = np.einsum("fpk,...p->...fk", self.waves, whitened)
        best = np.argmax(np.sum(components**2, axis=-1), axis=-1)
        chosen = np.take_along_axis(components, best[..., np.newaxis, np.newaxis], axis=-2)
        return chosen[..., 0, :], best

    def gain(self, whitened: FloatArray) -> FloatArray:
        """The largest reduction of chi^2 over all frequencies."""
        gain: FloatArray = np.sum(self.amplitudes(whitened)[0] ** 2, axis=-1)
        return gain


@dataclass(frozen=True)
class SeriesFit:
    """The fits of one series: log E at log(delta), with errors of log E."""

    log_delta: FloatArray
    log_excess: FloatArray
    weights: FloatArray  # 1/error, with the model error
    model_error: float
    bases: dict[str, Basis]
    whitened: FloatArray  # log E over its errors, without the power law
    chi_of_powers: FloatArray

    @classmethod
    def of(cls, series: Table) -> SeriesFit:
        """Finds the model error by bisection."""
        x, y = np.log(series["delta"]), np.log(series["excess"])
        error = series["standard_error"] / series["excess"]

        def with_error(model_error: float) -> tuple[FloatArray, FloatArray, dict[str, Basis]]:
            weights = 1 / np.hypot(error, model_error)
            bases = {name: _basis(x, weights, power) for name, power in _MODELS.items()}
            return weights, _without_power_law(weights * y, x, weights), bases

        def chi(model_error: float) -> float:
            _, whitened, bases = with_error(model_error)
            return float(whitened @ whitened - max(float(b.gain(whitened)) for b in bases.values()))

        freedom = len(x) - 5
        lower, upper = 0.0, _LARGEST_ERROR if chi(0) > freedom else 0.0
        for _ in range(12 if upper > 0 else 0):
            middle = (lower + upper) / 2
            lower, upper = (middle, upper) if chi(middle) > freedom else (lower, middle)
        weights, whitened, bases = with_error(upper)
        gains = [_basis(x, weights, power).gain(whitened) for power in _POWERS]
        chi_of_powers = whitened @ whitened - np.array(gains)
        return cls(x, y, weights, upper, bases, whitened, chi_of_powers)

    @property
    def chi_of_power_law(self) -> float:
        """chi^2 of the plain power law."""
        return float(self.whitened @ self.whitened)

    @property
    def gains(self) -> dict[str, float]:
        """By how much each oscillating model reduces chi^2."""
        return {name: float(basis.gain(self.whitened)) for name, basis in self.bases.items()}

    def rows(self, random: np.random.Generator, synthetic: int) -> list[dict[str, Any]]:
        """One for the power law and one for each oscillating model."""
        exponent, error, _ = self._parameters(None)
        chi = self.chi_of_power_law
        found = [_row("power law", chi, len(self.log_delta) - 2, b=exponent, b_error=error)]
        alarms = self._false_alarms(random, synthetic)
        for name, gain in self.gains.items():
            exponent, error, amplitude = self._parameters(name)
            _, best = self.bases[name].amplitudes(self.whitened)
            found.append(
                _row(
                    name,
                    chi - gain,
                    len(self.log_delta) - 5,
                    b=exponent,
                    b_error=error,
                    amplitude=amplitude,
                    period=2 * np.pi / self.bases[name].omegas[best],
                    gain=gain,
                    false_alarm=alarms[name],
                    p_value=self._p_value(name, random, synthetic),
                    **best_transform(self.chi_of_powers),
                )
            )
        return found

    def _parameters(self, name: str | None) -> tuple[float, float, float]:
        """b of a model with its error, and the amplitude c."""
        columns = [np.ones_like(self.log_delta), self.log_delta]
        if name is not None:
            basis = self.bases[name]
            _, best = basis.amplitudes(self.whitened)
            x = basis.omegas[best] * _variable(self.log_delta, basis.power)
            columns += [np.cos(x), np.sin(x)]
        fit = linear(np.column_stack(columns), self.log_excess, 1 / self.weights)
        amplitude = np.nan if name is None else float(np.hypot(*fit.coefficients[2:]))
        return float(fit.coefficients[1]), float(fit.errors[1]), amplitude

    def _noise(self, random: np.random.Generator, synthetic: int) -> FloatArray:
        """(synthetic, points): data sets of the power law, without the power law."""
        normal = random.standard_normal((synthetic, len(self.log_delta)))
        return _without_power_law(normal, self.log_delta, self.weights)

    def _false_alarms(self, random: np.random.Generator, synthetic: int) -> dict[str, float]:
        noise = self._noise(random, synthetic)
        chi = np.sum(noise**2, axis=1)
        alarms = {}
        for name, gain in self.gains.items():
            gained = self.bases[name].gain(noise)
            is_alarm = gained / (chi - gained) >= gain / (self.chi_of_power_law - gain)
            alarms[name] = float(np.mean(is_alarm))
        return alarms

    def _p_value(self, name: str, random: np.random.Generator, synthetic: int) -> float:
        basis = self.bases[name]
        amplitudes, best = basis.amplitudes(self.whitened)
        data = self._noise(random, synthetic) + basis.waves[best] @ amplitudes
        most = np.max([other.gain(data) for other in self.bases.values()], axis=0)
        worse = max(self.gains.values()) - self.gains[name]
        return float(np.mean(most - basis.gain(data) >= worse))


def best_transform(chi_of_powers: FloatArray) -> dict[str, float]:
    """The power with the smallest chi^2, and the range of those that are at most 4 above."""
    near = _POWERS[chi_of_powers <= chi_of_powers.min() + 4]
    best = _POWERS[np.argmin(chi_of_powers)]
    return {"transform": best, "transform_low": near.min(), "transform_high": near.max()}


def _sums(several: list[SeriesFit]) -> list[dict[str, Any]]:
    """Over the exponents of one energy."""
    points = sum(len(fit.log_delta) for fit in several)
    chi = sum(fit.chi_of_power_law for fit in several)
    found = [_row("power law", chi, points - 2 * len(several), points=points)]
    transform = best_transform(np.sum([fit.chi_of_powers for fit in several], axis=0))
    for name in _MODELS:
        gain = sum(fit.gains[name] for fit in several)
        freedom = points - 5 * len(several)
        found.append(_row(name, chi - gain, freedom, points=points, gain=gain, **transform))
    return found


def _row(model: str, chi: float, freedom: int, **known: float) -> dict[str, Any]:
    return {"model": model, "chi_squared": chi, "degrees_of_freedom": freedom} | known


def _variable(log_delta: FloatArray, power: float) -> FloatArray:
    """x = delta^-power, or log(delta)."""
    x: FloatArray = log_delta if power == 0 else np.exp(-power * log_delta)
    return x


def _without_power_law(data: FloatArray, log_delta: FloatArray, weights: FloatArray) -> FloatArray:
    """The part of data (..., points) that is orthogonal to the power laws."""
    plane, _ = np.linalg.qr(np.column_stack([weights, weights * log_delta]))
    rest: FloatArray = data - (data @ plane) @ plane.T
    return rest


def _basis(log_delta: FloatArray, weights: FloatArray, power: float) -> Basis:
    x = _variable(log_delta, power)
    most = len(x) / 3
    cycles = 1.5 + 0.15 * np.arange(1 + max(0, int(np.ceil((most - 1.5) / 0.15 - 1e-9))))
    omegas = 2 * np.pi * cycles / np.ptp(x)
    phases = np.outer(omegas, x)
    terms = np.broadcast_arrays(1.0, log_delta, np.cos(phases), np.sin(phases))
    orthonormal, _ = np.linalg.qr(weights[:, np.newaxis] * np.stack(terms, axis=-1))
    return Basis(power, orthonormal[:, :, 2:], omegas)
