"""The question: an experiment on a grid of parameters, and how much of it is computed.

The names are those of the command line. Units everywhere: lengths are cells, masses are 1, the
energy of a ball-piston pair is 1/2, the Boltzmann constant is 1.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from google.protobuf import json_format

from ballpiston.fields import from_spelling
from ballpiston.parameter_lists import INT64, UINT64, Numbers, Points, Shapes, add_list, add_points
from ballpiston.parameter_lists import real_number, truth_value, whole_number
from ballpiston.suggestion import did_you_mean
from ballpiston.v1 import spec_pb2


def specification(
    experiment: str,
    *,
    rho: Numbers | None = None,
    delta: Numbers | None = None,
    epsilon: Numbers | None = None,
    exponent: Numbers | None = None,
    cells: Shapes | None = None,
    temperature: Numbers | None = None,
    hot: Numbers | None = None,
    cold: Numbers | None = None,
    points: Points | None = None,
    samples: float | None = None,
    collisions: float | None = None,
    tolerance: float | None = None,
    budget: float | None = None,
    estimate: str | None = None,
    seed: int = 0,
    model: str | None = None,
    precision: str | None = None,
    verify: bool = False,
) -> Any:
    """A question, as the message ballpiston.v1.EnsembleSpec. Sends nothing.

    Each parameter of the grid takes a number, a list, an array, or a text such as "0.1:0.4:4"
    (from:to:count, as on the command line). The grid is the product of the lists, rho outermost, at
    most 100,000 points.

    Args:
        experiment: its name, such as "first-hit"; the error of a wrong name lists all.
        rho: radius of the discs; 1/2 < rho < 1/sqrt(2).
        delta: how far the piston reaches into the cell; 0 < delta <= (1 - sqrt(4 rho^2 - 1))/2.
        epsilon: energy of the piston; 0 to 1/2.
        exponent: n of the outgoing law h^(n); 0 to 1000.
        cells: shape of a gas: 8, a chain of 8 cells, or "10x5", a lattice of 10 columns and 5 rows;
            at most 10^6 cells in all.
        temperature: of a gas in equilibrium; 1e-120 to 1e120, by default 1.
        hot, cold: temperatures of the reservoirs; 1e-120 to 1e120, hot >= cold.
        points: a table of points in place of lists: a pandas.DataFrame, a dict of columns, or a
            list of dicts. The lists of other parameters multiply the table, whose rows vary
            slowest.
        samples: collisions, first hits, orbits or replicas of a gas, by the experiment, for each
            point; 1 to 10^12.
        collisions: ball-piston collisions for each point; 1 to 10^12.
        tolerance: relative standard error of the first estimate; between 0 and 1.
        budget: seconds of computing with all workers, for the whole grid; with a tolerance the job
            fails if some point does not reach it. Of samples, collisions, tolerance and budget give
            at most one, or tolerance and budget together.
        estimate: the estimate that the tolerance refers to, such as "conductivity"; the server's
            error of a wrong name lists those that the experiment permits.
        seed: of the random numbers; 0 to 2^64 - 1. Equal questions and seeds give equal numbers.
        model: "auto", "closed-form", "spectrum", "markov", "billiard" or "billiard-reference".
        precision: "double" or "single".
        verify: with "auto", also simulate what a closed form answers.

    Raises:
        TypeError: a value of a wrong type, or targets that exclude each other.
        ValueError: an unknown name, or a text or number that cannot be sent.

    Example:
        >>> question = specification("equilibrium", rho=0.5296, delta="0.1:0.3:3", collisions=1e6)
        >>> list(question.grid.delta)
        [0.1, 0.2, 0.3]
    """
    spec = spec_pb2.EnsembleSpec(verify=truth_value("verify", verify))
    spec.experiment = from_spelling(spec, "experiment", experiment)
    grid: dict[str, Any] = {"rho": rho, "delta": delta, "epsilon": epsilon, "exponent": exponent}
    grid |= {"cells": cells, "temperature": temperature, "hot": hot, "cold": cold}
    for name, values in grid.items():
        if values is not None:
            add_list(spec.grid, name, values)
    if points is not None:
        add_points(points, spec.grid)
    set_target(spec, samples=samples, collisions=collisions, tolerance=tolerance, budget=budget)
    if estimate is not None:
        if not isinstance(estimate, str):
            raise TypeError(f"estimate has to be a str, not {estimate!r}")
        spec.target.estimate = estimate
    spec.seed = whole_number("seed", seed, *UINT64)
    for name, text in (("model", model), ("precision", precision)):
        if text is not None:
            setattr(spec, name, from_spelling(spec, name, text))
    return spec


def question_of(experiment: object, question: Mapping[str, Any], others: Iterable[str] = ()) -> Any:
    """The message for the arguments of submit, run, plan and sample. In place of an experiment's
    name they take a message, such as job.specification, or its JSON as a dict. `others` are further
    keywords of the method, for suggestions. Raises TypeError: a keyword that does not exist; the
    message suggests the nearest one; ValueError: a dict that is not a specification."""
    if isinstance(experiment, str):
        for name in question:
            if name not in _KEYWORDS:
                hint = did_you_mean(name, [*_KEYWORDS, *others])
                raise TypeError(f"there is no keyword {name!r}{hint}")
        return specification(experiment, **question)
    if question:
        given = ", ".join(question)
        raise TypeError(
            f"a specification is already complete: do not also give {given}; change a copy of it"
        )
    if isinstance(experiment, spec_pb2.EnsembleSpec):
        return experiment
    if isinstance(experiment, Mapping):
        try:
            return json_format.ParseDict(dict(experiment), spec_pb2.EnsembleSpec())
        except json_format.ParseError as error:
            raise ValueError(f"not a specification: {error}") from error
    kind = type(experiment).__name__
    raise TypeError(f"the first argument has to be an experiment or a specification, not {kind}")


Method = TypeVar("Method", bound=Callable[..., Any])


def takes_keywords_of(other: Callable[..., Any]) -> Callable[[Method], Method]:
    """Decorates a method that passes **question on to `other`: the method's signature then shows
    the keywords of `other`, for help() and for completion in notebooks."""

    def with_signature(method: Method) -> Method:
        own = inspect.signature(method)
        parameters = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
        keywords = _keywords_of(other).values()
        shown = own.replace(parameters=[*parameters[:2], *keywords, *parameters[2:]])
        setattr(method, "__signature__", shown)
        return method

    return with_signature


def _keywords_of(function: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    parameters = inspect.signature(function).parameters
    return {name: p for name, p in parameters.items() if p.kind is p.KEYWORD_ONLY}


_KEYWORDS = _keywords_of(specification)


def set_target(spec: Any, **values: float | None) -> None:
    """Sets the target of an EnsembleSpec: samples, collisions, tolerance, budget; None: not given.
    Raises TypeError: targets that exclude each other; ValueError: a number that cannot be sent."""
    given = {name: value for name, value in values.items() if value is not None}
    if len(given) > 1 and list(given) != ["tolerance", "budget"]:
        raise TypeError(
            f"{' and '.join(given)} exclude each other: give at most one of samples, collisions, "
            "tolerance, budget; only tolerance and budget may stand together"
        )
    for name, value in given.items():
        if name == "budget":
            spec.target.budget.FromNanoseconds(_nanoseconds(real_number(name, value)))
        elif name == "tolerance":
            spec.target.tolerance = real_number(name, value)
        else:
            setattr(spec.target, name, whole_number(name, value, *INT64))


def _nanoseconds(budget: float) -> int:
    """The budget in nanoseconds. ValueError if it rounds to 0 without being 0, or exceeds 1e9 s;
    the server checks all other values."""
    nanoseconds = round(budget * 1e9) if abs(budget) <= 1e9 else 0
    if nanoseconds == 0 and budget != 0:
        raise ValueError(f"budget is {budget!r} s; permitted: 1e-9 to 1e6 s")
    return nanoseconds
