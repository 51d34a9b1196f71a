"""The estimates of many jobs in one table: a row for each estimate of each point."""

import sys
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from ballpiston.errors import NotFound, ResultsExpired
from ballpiston.fields import spelled
from ballpiston.job import Job
from ballpiston.point import ESTIMATE_FIELDS, PARAMETERS
from ballpiston.result import warnings_of
from ballpiston.table import Table
from ballpiston.v1 import ensemble_pb2

_OF_JOB = "job principal labels state experiment seed precision continues engine_version".split()
_TEXTS = (*_OF_JOB, "cells", "model", "name")
_COLUMNS = (*_OF_JOB, "index", *PARAMETERS, "model", "samples", "name", "value", *ESTIMATE_FIELDS)


def estimates_table(jobs: Iterable[Job]) -> Table:
    """Columns of equal length, NaN or "" where a value is absent: of each job the points that are
    finished. A job that `continues` another one contains its samples. Notes on standard error name
    each job that has not ended, each point whose orbits left the cell, and each job that is left
    out because its results have expired or it was deleted meanwhile. Raises ResultsExpired,
    NotFound: every job would be left out."""
    columns: dict[str, list[Any]] = {name: [] for name in _COLUMNS}
    left_out: list[ResultsExpired | NotFound] = []
    count = 0
    for count, job in enumerate(jobs, 1):
        if not hasattr(job, "result_in"):
            raise TypeError(f"jobs has to be a list of jobs; one item is a {type(job).__name__}")
        try:
            for row in _rows(job):
                for name, column in columns.items():
                    column.append(row.get(name, "" if name in _TEXTS else np.nan))
        except (ResultsExpired, NotFound) as error:
            left_out.append(error)
            why = str(error).splitlines()[0]
            print(f"ballpiston: {job.name} is left out: {why}", file=sys.stderr)
    if left_out and len(left_out) == count:
        raise left_out[-1]
    return {name: np.array(column) for name, column in columns.items()}


def _rows(job: Job) -> Iterator[dict[str, Any]]:
    has_ended = job.has_ended  # asks the server, unless it is known
    result = job.result_in(ensemble_pb2.ListResultsRequest.BASIC)
    if not has_ended:
        finished = f"{len(result)} of {job.message.progress.points} points are finished"
        print(f"ballpiston: {job.name} is still {result.state}: {finished}", file=sys.stderr)
    of_job = {
        "job": job.name,
        "principal": job.message.principal,
        "labels": " ".join(f"{key}={value}" for key, value in sorted(job.labels.items())),
        "state": result.state,
        "experiment": job.experiment,
        "seed": str(job.specification.seed),  # it may have more digits than a float
        "precision": "single" if spelled(job.specification, "precision") == "single" else "double",
        "continues": job.continues,
        "engine_version": job.message.engine_version,
    }
    for warning in warnings_of(result):
        print(f"ballpiston: {job.name}: {warning}", file=sys.stderr)
    for point in result:
        of_point = {"index": point.index, "model": point.model, "samples": point.message.samples}
        for estimate in point.estimates.values():
            known = {name: value for name, value in vars(estimate).items() if value is not None}
            yield of_job | point.parameters | of_point | known
