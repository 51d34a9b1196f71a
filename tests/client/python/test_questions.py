"""From keywords to the message that is sent, without a server."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

import ballpiston
from ballpiston.v1 import spec_pb2


def grid(**lists: Any) -> Any:
    return ballpiston.specification("first-hit", **lists).grid


@pytest.mark.parametrize(
    "values", [0.25, [0.25], (0.25,), np.array([0.25]), np.float64(0.25), np.array(0.25), "0.25"]
)
def test_one_number_may_be_written_in_many_ways(values: Any) -> None:
    assert list(grid(epsilon=values).epsilon) == [0.25]


def test_ranges_arrays_and_iterators_are_lists() -> None:
    assert list(grid(exponent=range(3)).exponent) == [0, 1, 2]
    assert list(grid(exponent=np.arange(3)).exponent) == [0, 1, 2]
    assert list(grid(exponent=(n for n in (1, 2))).exponent) == [1, 2]


def test_texts_are_lists_of_the_command_line() -> None:
    fractions = [n / 100 for n in range(1, 50)]
    assert list(grid(epsilon="0.01:0.49:49").epsilon) == fractions
    assert list(grid(delta="0.1,0.2:0.3:2").delta) == [0.1, 0.2, 0.3]
    assert list(grid(delta="0.01:1:3:log").delta) == pytest.approx([0.01, 0.1, 1])
    assert list(grid(epsilon="1e-309:0.1:3:log").epsilon) == [1e-309, 1e-155, 0.1]


def test_shapes_are_numbers_or_texts() -> None:
    assert list(grid(cells="10x10").cells) == ["10x10"]
    assert list(grid(cells=[4, np.int64(8), "1e3", "8x4"]).cells) == ["4", "8", "1000", "8x4"]
    assert list(grid(cells="2:8:3,16").cells) == ["2", "5", "8", "16"]


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ("0.1;0.2", ValueError),
        ("0.1:0.2", ValueError),
        ("nan", ValueError),
        ("", ValueError),
        ("+1", ValueError),
        ("1e400", ValueError),
        ("1e-400", ValueError),
        (bytearray(b"8"), TypeError),
        ("0:1:3:log", ValueError),
        (["0.1"], TypeError),
        ([True], TypeError),
        (np.array(True), TypeError),
        (object(), TypeError),
        ({0.1: 1}, TypeError),
        (np.zeros((2, 2)), ValueError),
        ("0.1:0.2:1", ValueError),
        pytest.param(10**400, ValueError, id="10**400"),
    ],
)
def test_what_is_not_a_list_is_an_error(values: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match="delta"):
        grid(delta=values)


@pytest.mark.parametrize("values", ["1e999", float("inf"), float("nan"), [8, 10**400]])
def test_a_chain_has_a_finite_number_of_cells(values: Any) -> None:
    with pytest.raises(ValueError, match="^cells"):
        grid(cells=values)


def test_whole_numbers_may_be_floats() -> None:
    assert ballpiston.specification("first-hit", samples=1e5).target.samples == 100_000
    with pytest.raises(TypeError, match="samples has to be a number"):
        ballpiston.specification("first-hit", samples=np.timedelta64(5, "s"))
    with pytest.raises(ValueError, match="whole number"):
        ballpiston.specification("first-hit", samples=1.5)


def test_a_switch_is_true_or_false(client: ballpiston.Client) -> None:
    assert ballpiston.specification("first-hit", verify=np.bool_(True)).verify
    with pytest.raises(TypeError, match="verify has to be True or False, not 'no'"):
        client.run("first-hit", verify="no")
    with pytest.raises(TypeError, match="fresh has to be True or False, not 'no'"):
        client.run("first-hit", fresh="no")


def test_a_seed_has_64_bits() -> None:
    for seed in (2**64 - 1, np.array(2**64 - 1)):
        assert ballpiston.specification("first-hit", seed=seed).seed == 2**64 - 1
    with pytest.raises(ValueError, match="seed"):
        ballpiston.specification("first-hit", seed=-1)


def test_numbers_that_cannot_be_sent_are_named(client: ballpiston.Client) -> None:
    with pytest.raises(ValueError, match="^seed has to be from 0 to"):
        client.trace(rho=0.5296, delta=0.1, events=1, seed=-1)
    with pytest.raises(ValueError, match="^events has to be from"):
        client.trace(rho=0.5296, delta=0.1, events=1e20)
    with pytest.raises(ValueError, match="^priority has to be from -100 to 100"):
        client.submit("first-hit", priority=10**12)
    with pytest.raises(TypeError, match="^estimate has to be a str, not 5"):
        ballpiston.specification("lyapunov", estimate=5)  # type: ignore[arg-type]


def test_a_budget_below_a_nanosecond_is_named_as_it_was_given() -> None:
    with pytest.raises(ValueError, match="budget is 1e-10 s; permitted: 1e-9"):
        ballpiston.specification("first-hit", budget=1e-10)


def test_only_tolerance_and_budget_stand_together() -> None:
    target = ballpiston.specification("first-hit", tolerance=0.01, budget=1.5).target
    assert (target.tolerance, target.budget.seconds, target.budget.nanos) == (0.01, 1, 500_000_000)
    with pytest.raises(TypeError, match="samples and tolerance exclude each other"):
        ballpiston.specification("first-hit", samples=10, tolerance=0.1)


def test_names_are_spelled_as_on_the_command_line() -> None:
    spec = ballpiston.specification("gas-equilibrium", model="billiard-reference")
    assert spec.experiment == spec_pb2.EnsembleSpec.GAS_EQUILIBRIUM
    assert spec.model == spec_pb2.EnsembleSpec.BILLIARD_REFERENCE
    with pytest.raises(ValueError, match="did you mean 'first-hit'"):
        ballpiston.specification("frist-hit")


def test_an_unknown_keyword_is_a_type_error_with_a_suggestion(client: ballpiston.Client) -> None:
    before = len(client.jobs(limit=None))
    with pytest.raises(TypeError, match="no keyword 'deltta'; did you mean 'delta'"):
        client.submit("first-hit", rho=0.5296, deltta=0.1)
    with pytest.raises(TypeError, match="did you mean 'samples'"):
        client.run("first-hit", rho=0.5296, sample=10)
    with pytest.raises(TypeError, match="did you mean 'labels'"):
        client.run("first-hit", label={})
    with pytest.raises(TypeError, match="no keyword 'labels'$"):
        client.sample("first-hit", labels={})
    assert len(client.jobs(limit=None)) == before


def test_a_wrong_progress_is_an_error_before_the_job_is_submitted(
    client: ballpiston.Client,
) -> None:
    before = len(client.jobs(limit=None))
    with pytest.raises(ValueError, match="progress is 'foo'; permitted: auto, bar, json, none"):
        client.run("equilibrium", rho=0.53, delta=0.1, samples=31, progress="foo")
    assert len(client.jobs(limit=None)) == before


def test_a_whole_specification_stands_alone(client: ballpiston.Client) -> None:
    spec = ballpiston.specification("equilibrium", rho=0.53, delta=0.1)
    with pytest.raises(TypeError, match="do not also give seed"):
        client.plan(spec, seed=1)
    document = {"experiment": "EQUILIBRIUM", "grid": {"rho": [0.53], "delta": [0.1]}}
    assert client.plan(document).message == client.plan(spec).message
    with pytest.raises(ValueError, match="not a specification"):
        client.plan({"experimnt": "EQUILIBRIUM"})


def test_help_lists_the_keywords() -> None:
    for method in (ballpiston.Client.submit, ballpiston.Client.run, ballpiston.Client.plan):
        assert {"rho", "delta", "samples", "seed", "verify"} <= set(
            inspect.signature(method).parameters
        )


def test_the_server_reports_all_violations_at_once(client: ballpiston.Client) -> None:
    with pytest.raises(ballpiston.InvalidSpecification) as caught:
        client.submit("equilibrium", rho=0.5296, delta=[0.1, 0.7], collisions=0)
    error = caught.value
    assert error.reason == "INVALID_SPEC" and error.code == "INVALID_ARGUMENT"
    assert sorted(field for field, _ in error.violations) == [
        "spec.grid.delta[1]",
        "spec.target.collisions",
    ]
    assert str(error).startswith("not valid, 2 violations (INVALID_SPEC):\n  spec.")
    assert isinstance(error, ValueError)


def test_a_single_violation_is_one_line(client: ballpiston.Client) -> None:
    with pytest.raises(ballpiston.InvalidSpecification) as caught:
        client.analytic(0.5296, 0.7)
    assert "\n" not in str(caught.value) and "(INVALID_REQUEST)" in str(caught.value)


def test_a_trace_reports_errors_of_the_server(client: ballpiston.Client) -> None:
    with pytest.raises(ballpiston.InvalidSpecification, match="events"):
        list(client.trace(rho=0.5296, delta=0.1, events=0))


@pytest.mark.parametrize("cells", [[], [4, "4x3"]])
def test_a_trace_has_one_shape_of_cells(client: ballpiston.Client, cells: Any) -> None:
    with pytest.raises(ValueError, match=f"cells: a trace has one shape, not {len(cells)}"):
        next(client.trace(rho=0.5296, delta=0.1, events=1, cells=cells))
