"""The numbers that the figures of docs/research compute."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_figures import expect_texts_inside

import ballpiston
from ballpiston.figures import full_counting, logarithm, lyapunov, slow_pistons
from ballpiston.figures.parts import charge, fits, tangent_growth


def test_a_fit_to_independent_values_is_that_of_numpy() -> None:
    x, errors = np.array([0.1, 0.2, 0.3, 0.5]), np.array([0.1, 0.2, 0.1, 0.3])
    values = np.array([2.4, 2.5, 2.8, 3.6])
    fit = fits.linear(np.vander(x, 2), values, errors)
    coefficients, covariance = np.polyfit(x, values, 1, w=1 / errors, cov="unscaled")
    residuals = (values - np.polyval(coefficients, x)) / errors
    assert fit.coefficients == pytest.approx(coefficients)
    assert fit.errors == pytest.approx(np.sqrt(np.diag(covariance)))
    assert (fit.chi_squared, fit.freedom) == (pytest.approx(residuals @ residuals), 2)


def test_a_mean_of_correlated_values_has_a_larger_error() -> None:
    correlation = np.array([[1.0, 0.5], [0.5, 1.0]])
    fit = fits.linear(np.ones((2, 1)), np.array([1.0, 3.0]), np.ones(2), correlation)
    assert (fit.coefficients[0], fit.errors[0]) == pytest.approx((2, np.sqrt(0.75)))
    assert fit.chi_squared == pytest.approx(4)


@pytest.mark.parametrize("order", [2, 3])
def test_the_growth_of_successive_windows_is_correlated(order: int) -> None:
    # Charges of the windows of length 1, 2, 4 and 8 in stretches of normal noise. The means of
    # their Hermite polynomials He_n estimate the cumulants.
    noise = np.random.default_rng(1).standard_normal((50_000, 16))
    v = []
    for t in (1, 2, 4, 8):
        q = noise.reshape(50_000, -1, t).sum(axis=2)
        hermite = q**order - order * (order - 1) / 2 * t * q ** (order - 2)
        v.append(hermite.mean(axis=1) / t)
    growth = [2 * later - earlier for earlier, later in zip(v, v[1:])]
    chain = np.array([4.0, 4, 4, 6])
    expected = charge.correlations(chain, order)
    assert np.corrcoef(growth) == pytest.approx(expected[:3, :3], abs=0.03)  # 6 standard errors
    assert expected[3].tolist() == [0, 0, 0, 1]


def test_the_limit_of_a_cumulant_has_the_error_of_correlated_windows() -> None:
    cells = np.repeat([4.0, 6, 8, 12], 5)
    found = {"cells": cells, "order": np.full(20, 2.0), "time": np.ones(20)}
    found |= {"value": np.ones(20), "standard_error": np.tile(2.0 ** (np.arange(5) / 2), 4)}
    share = np.vander(1 / cells, 3, increasing=True)
    independent = fits.linear(share, found["value"], found["standard_error"])
    limit = full_counting.extrapolated(found, 1.5, 0.5)["standard_error"][1]
    assert 1.2 < limit / independent.errors[0] < 1.6


def point_with_curve(order: int, value: Any, error: Any) -> Any:
    time = 2.0 ** np.arange(len(value))
    name = f"charge_cumulant_{order}_by_window"
    curve = SimpleNamespace(name=name, x=time, value=value, standard_error=error)
    return SimpleNamespace(curves=[curve], curve=lambda _: curve)


def test_the_growth_of_a_cumulant_does_not_contain_a_constant() -> None:
    time = 2.0 ** np.arange(5)
    point = point_with_curve(3, 7 + 4 / time, np.ones(5))
    assert charge.combined(point, 3, longer=2)["value"] == pytest.approx(np.full(4, 7))
    assert len(charge.combined(point, 4, longer=2)["value"]) == 0


def test_the_increase_of_the_variance_has_the_error_of_the_shorter_window() -> None:
    error = 0.1 * np.sqrt(2.0) ** np.arange(5)  # independent windows
    point = point_with_curve(2, np.ones(5), error)
    increase = charge.combined(point, 2, longer=1)
    assert increase["value"] == pytest.approx(np.zeros(4))
    assert increase["standard_error"] == pytest.approx(error[:-1])


def test_limits_of_full_counting_are_those_of_integrals_by_quadrature() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = 1 + nodes / 2
    i1, i2, i3, i4 = (weights / 2 @ (np.sqrt(t) * (2 * t**2.5) ** n) for n in range(4))
    fourth = 3 * (5 * i4 * i1**2 - 14 * i1 * i2 * i3 + 9 * i2**3) / i1**5
    expected = [i1, i2 / i1, 3 * (i3 * i1 - i2**2) / i1**3, fourth]
    assert full_counting.limits(1.5, 0.5) == pytest.approx(expected, rel=1e-12)
    assert expected == pytest.approx([0.98904, 2.52770, 6.92784, 34.2513], rel=5e-6)


def test_cumulants_that_were_not_measured_are_drawn_as_such() -> None:
    order = np.array([1.0, 1, 1, 1, 2, 2, 2])
    cells = np.array([4.0, 6, 8, 12, 4, 4, 6])  # the variance has only two chains
    found = {"cells": cells, "order": order, "time": np.full(7, np.inf)}
    found |= {"value": np.full(7, 2.0), "standard_error": np.full(7, 0.01)}
    fits_of_orders = full_counting.extrapolated(found, 1.5, 0.5)
    assert np.isnan(fits_of_orders["a0"]).tolist() == [False, True, True, True]
    tables = {"full-counting": found, "full-counting-limits": fits_of_orders}
    panels = full_counting.draw(tables).axes
    texts = [text.get_text() for axes in panels for text in axes.texts]
    assert texts == ["not measured: too few collisions"] * 2
    assert panels[0].get_ylim()[1] > 2  # includes the points


def test_growths_that_were_not_measured_are_drawn_as_such(
    client: ballpiston.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    idle = {"time": np.full(2, 64.0), "limit": np.ones(2), "limit_error": np.full(2, 0.1)}
    monkeypatch.setattr(slow_pistons, "table_of", lambda *_, **__: idle)
    tables = slow_pistons.measure(client, delta=0.2, cold=0.1, samples=10)
    assert np.isnan(tables["slow-pistons"]["growth"]).all()
    panels = slow_pistons.draw(tables).axes
    texts = [text.get_text() for axes in panels for text in axes.texts]
    assert texts == ["not measured: too few samples"] * 2


def test_in_equilibrium_the_slowest_rate_is_that_of_diffusion() -> None:
    assert full_counting.slowest_rate(1.0, 1.0) == pytest.approx(np.pi**2, rel=1e-4)


def windows_of(x: Any, excess: Any) -> dict[str, Any]:
    ones = np.ones(len(x))
    windows = {"x": x, "window": 8 * ones, "limit_all": 0.5 * ones, "limit_idle": 0.9 * ones}
    limits = {"all": 0.5, "idle": 0.9, "met": -0.4}
    for part, limit in limits.items():
        windows |= {part: limit + 0.541387668432 * excess, f"{part}_error": 0.001 * ones}
    return windows


def test_a_logarithm_of_delta_is_found_with_its_factor() -> None:
    x = np.array([0.05, 0.02, 0.01, 0.002])
    found = logarithm.logarithms_of_delta(windows_of(x, 0.3 * x + 0.4 * x * np.log(1 / x)))
    assert found["part"].tolist() == ["all", "idle", "met"]
    assert found["a"] == pytest.approx(np.full(3, 0.3))
    assert found["b"] == pytest.approx(np.full(3, 0.4))
    assert (found["plain_chi_squared"] > 20).all()


@pytest.mark.filterwarnings("error")
def test_a_logarithm_of_the_window_is_found_beside_a_part_that_ends() -> None:
    window, ones = 8 * 2.0 ** np.arange(5), np.ones(5)
    grown = 0.01 * np.log(window / 8) + 0.2 * (1 / 8 - 1 / window)
    whole = {"delta": 0.2 * ones, "window": window, "law": 0.01 * ones}
    whole |= {"limit_all": 0 * ones, "limit_idle": 0 * ones}
    whole |= {"later_idle": grown, "later_met": -grown}
    whole |= {f"later_{part}_error": 0.001 * np.arange(5) for part in ("idle", "met")}
    found = logarithm.logarithms_of_window(whole)
    assert (found["idle"][0], found["met"][0]) == pytest.approx((1, -1))
    # Growth without an error is left out.
    whole["later_idle_error"] = np.array([0, 1, 2, 2, np.nan])
    whole["later_met_error"] = np.array([0, 1, np.nan, np.nan, np.nan])
    found = logarithm.logarithms_of_window(whole)
    assert (found["idle"][0], found["idle_freedom"][0]) == (pytest.approx(1), 0)
    assert np.isnan(found["met"][0])


def test_a_single_rare_delta_has_two_orbits_and_one_place_in_the_picture(
    client: ballpiston.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[dict[str, Any]] = []

    def windows(program: str, command: str, **flags: Any) -> dict[str, Any]:
        asked.append(flags)
        values = [f"{kind}{part}" for kind in ("", "later_") for part in logarithm.PARTS]
        names = (*values, *(f"{name}_error" for name in values), "limit_all", "limit_idle")
        return {"window": 8 * 2.0 ** np.arange(5)} | {name: np.ones(5) for name in names}

    monkeypatch.setattr(logarithm, "table_of", windows)
    figure = logarithm.draw(logarithm.measure(client, rho=0.7, delta=0.004, samples=300))
    assert asked[0]["orbits"] == 2
    bars = figure.axes[1].containers
    assert figure.axes[1].get_ylim()[1] > 100  # includes the bars
    assert len(bars) == 3 and len({bar.lines[0].get_xdata()[0] for bar in bars}) == 1
    logarithm.measure(client, rho=0.7, delta="0.004,0.003", samples=300)
    assert asked[-1]["seed"] != asked[-2]["seed"]  # so that their runs are independent


# The second Lyapunov exponent

RHO = 0.53


def test_the_rate_of_collisions_is_that_of_the_closed_forms(client: ballpiston.Client) -> None:
    forms = client.analytic(RHO, 0.1, "0.01,0.125,0.25,0.3,0.49")
    rates = tangent_growth.collision_rate(np.sqrt(2 * forms["epsilon"][0]))
    assert rates == pytest.approx(forms["phi"][0], rel=1e-12)


def test_drawn_collisions_have_the_invariant_measure() -> None:
    count, delta = 100_000, 1e-3
    x, y, vx, vy, p = tangent_growth.draw(np.random.default_rng(1), RHO, delta, count)
    width = np.sqrt(4 * RHO**2 - 1)
    assert (vx > p).all()
    assert vx**2 + vy**2 + p**2 == pytest.approx(1)
    # Near the tip the cell is a wedge, so the mean depth is 2/3 of delta, within a share of
    # delta/lambda. The standard error is 0.0008 of delta; a bound of 0.007 is never exceeded.
    depth = (1 - width) / 2 - x
    assert depth.mean() / delta == pytest.approx(2 / 3, abs=0.007)
    assert abs(y).max() / delta == pytest.approx(width, abs=0.007)
    logarithms = np.log(vy**2 / np.abs(vx * p))
    error = logarithms.std() / np.sqrt(count)  # five of them: a false alarm in two million
    assert abs(logarithms.mean() - tangent_growth.mean_logarithms()[1]) < 5 * error


@pytest.mark.parametrize("rho", [RHO, 0.7])
def test_a_ball_between_two_opposite_discs_has_the_curvature_of_its_periodic_orbit(
    rho: float,
) -> None:
    gap = np.sqrt(2) - 2 * rho
    at_disc = np.sqrt(1 / rho**2 + 2 / (rho * gap)) - 1 / rho  # k = k/(1 - k gap) - 2/rho
    centre, along = np.zeros(1), np.full(1, np.sqrt(0.5))
    found = tangent_growth.stable_curvature(rho, centre, centre, along, along)
    assert found == pytest.approx([at_disc / (1 - at_disc * gap / 2)], rel=1e-9)


def test_a_collision_stretches_the_unstable_and_contracts_the_stable_direction() -> None:
    c, unstable, stable = (np.array([value]) for value in (0.3, 2.0, 5.0))
    m = tangent_growth.mixing_matrix(c, unstable, stable)[:, :, 0]
    assert m @ [1, 2] == pytest.approx(np.array([1, 2]) / 0.3)
    assert m @ [1, -5] == pytest.approx(np.array([1, -5]) * 0.3)


def test_the_second_exponent_is_that_of_the_billiard(client: ballpiston.Client) -> None:
    delta = 0.05
    tau = float(client.analytic(RHO, delta)["tau_ball_piston"][0])
    growth = tangent_growth.second_exponent(RHO, delta, tau, samples=16_384)
    question = {"rho": RHO, "delta": delta, "collisions": 20_000, "seed": 1}
    point = client.run("lyapunov", estimate="lyapunov_2_per_collision", **question)[0]
    measured = point.estimates["lyapunov_2_per_collision"]
    error = np.hypot(growth["computed_error"], float(measured.standard_error or np.nan))
    assert error < 0.03
    # One false alarm in two million runs.
    assert abs(measured.value - growth["computed"]) < 5 * error
    assert growth["computed"] - growth["long_waits"] > 0.2  # the terms in 1/t are tested, too


def measured_exponents(tau: Any) -> dict[str, Any]:
    ones = np.ones(len(tau))
    whole = {"delta": 1 / np.sqrt(tau), "tau": tau, "computed": np.log(tau) - 1 / np.sqrt(tau)}
    whole |= {"value": np.log(tau) + 0.5 - 1 / np.sqrt(tau), "value_error": 0.01 * ones}
    return whole | {"computed_error": 0.001 * ones}


def test_a_logarithm_of_the_mean_free_time_is_told_from_a_power() -> None:
    found = lyapunov.laws(measured_exponents(np.array([10.0, 2e3, 5e3, 1e4, 1e6])))
    of = dict(zip(found["law"].tolist(), zip(found["B"], found["chi_squared"], found["freedom"])))
    assert of["logarithm and computed terms"] == pytest.approx((1, 0, 2), abs=1e-9)
    assert of["power"][1] > 100 and of["constant"][1] > 1000
    assert of["computed"][1:] == pytest.approx((4 * 0.5**2 / (0.01**2 + 0.001**2), 4))
    # Fits without enough points are left out.
    few = lyapunov.laws(measured_exponents(np.array([10.0, 2e3])))
    assert few["law"].tolist() == ["constant", "computed"]


@pytest.mark.parametrize(("rho", "delta"), [(0.56, 0.1), (0.7, 0.004), (0.707, 1e-4)])
def test_the_computed_curve_ends_at_the_largest_delta(
    client: ballpiston.Client, rho: float, delta: float
) -> None:
    tables = lyapunov.measure(client, rho=rho, delta=delta, collisions=6400, samples=64)
    deltas = tables["lyapunov-curve"]["delta"]
    assert deltas[-1] == pytest.approx((1 - np.sqrt(4 * rho**2 - 1)) / 2, rel=1e-12)
    assert (np.diff(deltas) > 0).all()
    # The first two are 0.0036 apart in the law, and have the same random numbers.
    computed = (tables["lyapunov-curve"]["computed"] - np.log(tables["lyapunov-curve"]["tau"]))[:2]
    assert abs(np.diff(computed)) < 0.03
    found = tables["lyapunov"]
    assert found["samples"].tolist() == [6400]
    error = np.hypot(found["value_error"], found["computed_error"])
    assert abs(found["value"] - found["computed"]) < 5 * error  # one false alarm in a million runs
    expect_texts_inside(lyapunov.draw(tables))
