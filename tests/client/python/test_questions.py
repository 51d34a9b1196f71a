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


ONE = (0.25, [0.25], (0.25,), np.array([0.25]), np.float64(0.25), np.array(0.25), "0.25")


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        *(("epsilon", value, [0.25]) for value in ONE),
        ("exponent", range(3), [0, 1, 2]),
        ("exponent", np.arange(3), [0, 1, 2]),
        ("exponent", (n for n in (1, 2)), [1, 2]),
        ("epsilon", "0.01:0.49:49", [n / 100 for n in range(1, 50)]),
        ("delta", "0.1,0.2:0.3:2", [0.1, 0.2, 0.3]),
        ("delta", "0.01:1:3:log", [0.01, 0.1, 1]),
        ("epsilon", "1e-309:0.1:3:log", [1e-309, 1e-155, 0.1]),
        ("cells", "10x10", ["10x10"]),
        ("cells", [4, np.int64(8), "1e3", "8x4"], ["4", "8", "1000", "8x4"]),
        ("cells", "2:8:3,16", ["2", "5", "8", "16"]),
    ],
)
def test_a_list_may_be_written_in_many_ways(name: str, values: Any, expected: list[Any]) -> None:
    assert list(getattr(grid(**{name: values}), name)) == expected


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


def test_numbers_and_names_may_be_written_in_many_ways() -> None:
    for seed in (2**64 - 1, np.array(2**64 - 1)):
        assert ballpiston.specification("first-hit", seed=seed).seed == 2**64 - 1
    assert ballpiston.specification("first-hit", samples=1e5).target.samples == 100_000
    target = ballpiston.specification("first-hit", tolerance=0.01, budget=1.5).target
    assert (target.tolerance, target.budget.seconds, target.budget.nanos) == (0.01, 1, 500_000_000)
    model, verify = "billiard-reference", np.bool_(True)
    spec = ballpiston.specification("gas-equilibrium", model=model, verify=verify)
    assert spec.experiment == spec_pb2.EnsembleSpec.GAS_EQUILIBRIUM
    assert spec.model == spec_pb2.EnsembleSpec.BILLIARD_REFERENCE
    assert spec.verify


@pytest.mark.parametrize(
    ("keywords", "error", "text"),
    [
        ({"experiment": "frist-hit"}, ValueError, "did you mean 'first-hit'"),
        ({"model": "model-unspecified"}, ValueError, "is not a value of model"),
        ({"samples": np.timedelta64(5, "s")}, TypeError, "samples has to be a number"),
        ({"samples": 1.5}, ValueError, "whole number"),
        ({"samples": 10, "tolerance": 0.1}, TypeError, "samples and tolerance exclude each other"),
        ({"budget": 1e-10}, ValueError, "budget is 1e-10 s; permitted: 1e-9"),
        ({"seed": -1}, ValueError, "^seed has to be from 0 to"),
        ({"priority": 10**12}, ValueError, "^priority has to be from -100 to 100"),
        ({"estimate": 5}, TypeError, "^estimate has to be a str, not 5"),
        ({"verify": "no"}, TypeError, "verify has to be True or False, not 'no'"),
        ({"fresh": "no"}, TypeError, "fresh has to be True or False, not 'no'"),
        ({"progress": "foo"}, ValueError, "'foo'; permitted: auto, bar, json, none"),
        ({"deltta": 0.1}, TypeError, "no keyword 'deltta'; did you mean 'delta'"),
        ({"sample": 10}, TypeError, "did you mean 'samples'"),
        ({"label": {}}, TypeError, "did you mean 'labels'"),
    ],
)
def test_a_wrong_value_is_an_error_before_a_job_is_submitted(
    client: ballpiston.Client, keywords: dict[str, Any], error: type[Exception], text: str
) -> None:
    before = len(client.jobs(limit=None))
    question = {"experiment": "equilibrium", "rho": 0.53, "delta": 0.1} | keywords
    with pytest.raises(error, match=text):
        client.run(**question)
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


def test_errors_of_other_calls_are_named(client: ballpiston.Client) -> None:
    with pytest.raises(TypeError, match="no keyword 'labels'$"):
        client.sample("first-hit", labels={})
    with pytest.raises(ballpiston.InvalidSpecification) as caught:
        client.analytic(0.5296, 0.7)  # a single violation is one line
    assert "\n" not in str(caught.value) and "(INVALID_REQUEST)" in str(caught.value)
    with pytest.raises(ballpiston.InvalidSpecification, match="events.*permitted"):
        next(client.trace(rho=0.5296, delta=0.1, events=0))


@pytest.mark.parametrize(
    ("keywords", "text"),
    [
        ({"seed": -1}, "^seed has to be from 0 to"),
        ({"events": 1e20}, "^events has to be from"),
        ({"cells": []}, "cells: a trace has one shape, not 0"),
        ({"cells": [4, "4x3"]}, "cells: a trace has one shape, not 2"),
    ],
)
def test_a_wrong_value_is_an_error_before_a_trace_is_read(
    client: ballpiston.Client, keywords: dict[str, Any], text: str
) -> None:
    with pytest.raises(ValueError, match=text):
        client.trace(**{"rho": 0.5296, "delta": 0.1, "events": 1} | keywords)
