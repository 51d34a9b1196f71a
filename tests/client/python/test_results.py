"""Results as arrays, frames, histograms and curves."""

from __future__ import annotations

import html
import math
from unittest.mock import MagicMock

import numpy as np
import pytest

import ballpiston
from ballpiston.arrays import by_name
from ballpiston.point import measured_text
from ballpiston.v1 import server_pb2


def test_a_name_gives_an_array_over_the_points(first_hits: ballpiston.Result) -> None:
    values, errors = first_hits["mean_hit_time"], first_hits.error("mean_hit_time")
    assert values.shape == errors.shape == (len(first_hits),) == (4,)
    assert np.all(values > 0) and np.all(errors > 0)
    # Only the stationary law h^(1) has a closed form: the exponents are 1, 2, 1, 2.
    exact = first_hits.exact("mean_hit_time")
    assert np.isnan(exact).tolist() == [False, True, False, True]
    expected = (values - exact) / errors
    np.testing.assert_allclose(first_hits.z_score("mean_hit_time"), expected, rtol=1e-12)
    assert list(first_hits.parameters) == ["rho", "delta", "epsilon", "exponent"]
    assert first_hits.parameters["delta"].tolist() == [0.1, 0.1, 0.05, 0.05]


def test_a_loop_over_points_may_ask_for_everything_at_each(first_hits: ballpiston.Result) -> None:
    for name in ("parameters", "samples", "models", "remarks"):
        assert getattr(first_hits, name) is getattr(first_hits, name)
    for array in (first_hits.samples, *first_hits.parameters.values()):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_by_name_walks_once_for_each_name(first_hits: ballpiston.Result) -> None:
    points = MagicMock()
    points.__iter__.side_effect = lambda: iter(first_hits.messages)
    by_name(points, "estimates")
    assert points.__iter__.call_count == 1 + len(first_hits.names)


def test_a_number_gives_one_point(first_hits: ballpiston.Result) -> None:
    point = first_hits[3]
    assert point.index == 3
    assert point.parameters == {"rho": 0.5296, "delta": 0.05, "epsilon": 0.125, "exponent": 2}
    assert point["mean_hit_time"] == first_hits["mean_hit_time"][3]
    assert point.estimates["mean_hit_time"].exact is None
    assert point.model == "billiard" and point.samples == 2000
    assert [p.index for p in first_hits] == [0, 1, 2, 3]
    assert first_hits[-1].index == 3
    with pytest.raises(IndexError):
        first_hits[4]
    with pytest.raises(TypeError, match=r"the name of an estimate or a number, not slice\(0, 2"):
        first_hits[0:2]  # type: ignore[call-overload]


def test_a_divergence_is_an_estimate_with_its_noise_floor(first_hits: ballpiston.Result) -> None:
    assert first_hits.names[-1] == "kl_divergence"
    kl = first_hits[0].message.kl_divergence
    assert first_hits["kl_divergence"][0] == kl.value
    assert first_hits.noise_floor("kl_divergence")[0] == kl.noise_floor


def test_the_density_of_both_signs_of_an_angle_integrates_to_one(
    first_hits: ballpiston.Result,
) -> None:
    signs = [first_hits.histogram("alpha", sigma=sign) for sign in (+1, -1)]
    assert sum(h.counts.sum() for h in signs) == 2000
    assert sum(np.sum(h.density * np.diff(h.edges)) for h in signs) == pytest.approx(1)
    assert sum(h.expected.sum() for h in signs) == pytest.approx(1)
    for h in signs:
        assert len(h.edges) == len(h.counts) + 1 == len(h.centers) + 1
        np.testing.assert_allclose(h.expected_density * np.diff(h.edges), h.expected)


def test_a_name_that_does_not_exist_lists_those_that_do(first_hits: ballpiston.Result) -> None:
    assert "mean_hit_time" in first_hits and "mean_hit_tim" not in first_hits
    with pytest.raises(KeyError, match="did you mean 'mean_hit_time'"):
        first_hits["mean_hit_tim"]
    with pytest.raises(KeyError, match="this point has survival"):
        first_hits.curve("survivor")
    with pytest.raises(KeyError, match="there are several: choose sigma=-1 or sigma=.1"):
        first_hits.histogram("alpha")
    with pytest.raises(KeyError, match="none with sigma=3: choose sigma=-1 or sigma=.1"):
        first_hits.histogram("alpha", sigma=3)
    with pytest.raises(KeyError, match="none with time=3: choose sigma=-1 or sigma=.1"):
        first_hits.histogram("alpha", sigma=1, time=3)
    with pytest.raises(KeyError, match="this point has alpha"):
        first_hits.histogram("beta")


def test_a_curve_has_times_values_and_errors(first_hits: ballpiston.Result) -> None:
    curve = first_hits.curve("survival", point=1)
    assert curve.position is None and curve.time is not None
    assert curve.x[0] == 0 and curve.value[0] == 1
    assert np.all(np.diff(curve.x) > 0) and np.all(np.diff(curve.value) <= 0)
    assert len(curve.x) == len(curve.value) == len(curve.standard_error) == len(curve.limit)


def test_histograms_at_several_times_have_an_axis_of_times(client: ballpiston.Client) -> None:
    question = {"rho": 0.5296, "delta": [0.1, 0.2], "epsilon": 0.125, "samples": 500}
    result = client.run("energy-relaxation", **question, model="billiard")
    arrays = result.arrays()
    counts, times = arrays["histogram_piston_energy_counts"], arrays["histogram_piston_energy_time"]
    assert counts.shape[:2] == times.shape == (2, 6)
    nearest = result.histogram("piston_energy", time=1.01 * times[1, 2], point=1)
    assert nearest.time == times[1, 2]
    np.testing.assert_array_equal(nearest.counts, counts[1, 2])
    with pytest.raises(KeyError, match="there are several: choose time=.* or time="):
        result.histogram("piston_energy")
    with pytest.raises(KeyError, match="none with sigma=1: choose time="):
        result.histogram("piston_energy", sigma=1)


def test_shorter_curves_are_padded_with_nan(client: ballpiston.Client) -> None:
    question = {"rho": 0.5296, "delta": 0.1, "cells": [2, "4"], "hot": 1.5, "cold": 0.5}
    result = client.run("gas-conduction", **question, samples=2)
    arrays = result.arrays()
    assert arrays["cells"].tolist() == ["2", "4"]
    assert "epsilon" not in arrays
    position = arrays["curve_temperature_profile_position"]
    lengths = [len(result.curve("temperature_profile", point=i).x) for i in (0, 1)]
    assert lengths[0] < lengths[1] == position.shape[1]
    assert np.isnan(position[0]).sum() == lengths[1] - lengths[0]
    assert "curve_temperature_profile_time" not in arrays


def test_a_model_without_samples_has_no_counts(client: ballpiston.Client) -> None:
    result = client.run("energy-relaxation", rho=0.5296, delta=0.1, epsilon=0.1, model="spectrum")
    arrays = result.arrays()
    assert "histogram_piston_energy_expected" in arrays
    assert "histogram_piston_energy_counts" not in arrays
    histogram = result[0].histograms[0]
    assert histogram.counts.size == histogram.density.size == 0
    assert histogram.expected_density.sum() * np.diff(histogram.edges)[0] == pytest.approx(1)


def test_a_frame_has_one_row_a_point(first_hits: ballpiston.Result) -> None:
    pandas = pytest.importorskip("pandas")
    frame = first_hits.to_frame()
    assert isinstance(frame, pandas.DataFrame)
    assert len(frame) == 4
    assert "provenance" not in frame and "histogram_alpha_plus_counts" not in frame
    np.testing.assert_array_equal(frame["mean_hit_time"], first_hits["mean_hit_time"])
    assert frame.groupby("delta")["mean_hit_time"].mean()[0.05] > 100


def test_tables_show_values_with_their_errors(first_hits: ballpiston.Result) -> None:
    text, page = repr(first_hits), first_hits._repr_html_()
    assert "mean_hit_time" in text and "±" in text
    assert page.count("<tr>") == 5
    assert html.escape(first_hits.job_name) in page


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (21.63214, 0.1234, "21.63 ± 0.12"),
        (21.63214, None, "21.6321"),
        (21.63214, math.nan, "21.6321"),
        (2663.489678, 8.1e-8, "2663.489678000 ± 0.000000081"),
        (1234.5678901234, 1e-10, "1234.56789012"),
        (1 / 3, 0.0, "0.333333333333"),
        (0.0, 0.0, "0 ± 0"),
        (-1.25e-6, 3e-7, "-1.25e-06 ± 3.0e-07"),
        (12345678.0, 120.0, "1.234568e+07 ± 1.2e+02"),
    ],
)
def test_a_value_has_the_digits_of_its_error(value: float, error: float, text: str) -> None:
    assert measured_text(value, error) == text


def test_closed_forms_are_arrays_over_pairs_and_energies(client: ballpiston.Client) -> None:
    forms = client.analytic(
        0.5296, [0.1, 0.2], [0.1, 0.2, 0.3], outgoing_epsilon=0.1, temperature=[1, 2]
    )
    assert forms["delta"].tolist() == [0.1, 0.2]
    assert forms["phi"].shape == (2, 3)
    assert forms["kernel"].shape == (2, 3, 1)
    assert forms["exchange_rate"].shape == (2, 2)
    tau = forms["tau_ball_piston"][:, None] / forms["phi"]
    np.testing.assert_allclose(forms["mean_free_time_conditional"], tau, rtol=1e-12)
    with pytest.raises(KeyError, match="did you mean 'tau_ball_piston'"):
        forms["tau_ball_pistn"]


def test_a_plan_names_the_model_that_would_answer(client: ballpiston.Client) -> None:
    plan = client.plan("equilibrium", rho=0.5296, delta=[0.1, 0.2])
    assert plan.models == ["closed-form", "closed-form"]
    assert plan.points == 2
    assert "closed-form" in repr(plan) and "closed-form" in plan._repr_html_()


def test_a_trace_has_the_start_and_the_events_in_order(client: ballpiston.Client) -> None:
    events = list(client.trace(rho=0.5296, delta=0.2, events=1000, seed=3))
    assert events[0]["event"] == "start" and len(events[0]["balls"]) == 1
    assert len(events) == 1001
    times = [event["time"] for event in events]
    assert times == sorted(times)
    assert events[1:] != list(client.trace(rho=0.5296, delta=0.2, events=1000, seed=4))[1:]


def test_the_status_names_the_server(
    client: ballpiston.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    status = client.status()
    assert status.state == "serving" and status.role == "admin"
    assert status.version == ballpiston.__version__
    assert status.limits["max_points_per_job"] == 100_000
    monkeypatch.setattr(client._connection, "call", lambda _: server_pb2.ServerStatus())
    assert client.status().limits["max_points_per_job"] == 0
