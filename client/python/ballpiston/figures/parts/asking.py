"""Questions of the figures to the server, and the types of their parameters."""

import itertools
import os
import uuid
from typing import Any

import numpy as np

from ballpiston.client import Client as Client
from ballpiston.fields import column
from ballpiston.figures.parts.tables import Table
from ballpiston.parameter_lists import Numbers as Numbers, Shapes as Shapes
from ballpiston.parameter_lists import number_list as number_list, shape_list
from ballpiston.result import Result
from ballpiston.specification import specification

RHO = 0.529561127988977  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
ENERGIES = "0.03125,0.125,0.25,0.375,0.46875"  # of the piston, below and above the ball's, 1/4

_NAMESPACE = uuid.UUID("6c1f8b0e-4f0b-4c6e-9d43-0c7d1c1a7f11")


def answer(client: Client, experiment: str, **question: Any) -> Result:
    """The result of a question. If the same question was asked before, its job is used again: the
    ids are tried in order, and if the job of an id failed or was cancelled, or its results have
    expired, the next id makes a new job."""
    spec = specification(experiment, **question)
    key = f"{client.status().engine_version} {spec.SerializeToString(deterministic=True)!r}"
    for attempt in itertools.count():
        job = client.submit(spec, request_id=uuid.uuid5(_NAMESPACE, f"{key} {attempt}"))
        lost = ("failed", "cancelled", "cancelling")
        if job.state not in lost and not job.message.results_expired:
            break
    return job.watch(os.environ.get("BALLPISTON_PROGRESS") or "auto")


def divergences(result: Result) -> Table:
    """The relative entropy of the ingoing law of first hits at each point, with its noise floor:
    its mean, and the standard deviation `noise_error`, if the two laws were equal."""
    found = {name: result.parameters[name].copy() for name in ("delta", "epsilon", "exponent")}
    for field in ("value", "standard_error", "noise_floor", "noise_error"):
        found[field] = column((m.kl_divergence for m in result.messages), field)
    return found


def in_mean_free_times(client: Client, curves: Table) -> Table:
    """With the column `t`, the time in units of the mean free time of the row's delta."""
    delta, row = np.unique(curves["delta"], return_inverse=True)
    tau = client.analytic(curves["rho"][0], delta)["tau_ball_piston"]
    return curves | {"t": curves["time"] / tau[row]}


def check_chains(cells: Shapes) -> None:
    """Raises ValueError if one of the shapes is a lattice."""
    for shape in shape_list("cells", cells):
        if "x" in shape:
            raise ValueError(f"cells: {shape} is a lattice; permitted: lengths of chains")
