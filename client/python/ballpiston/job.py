"""A job on a server: one question, its progress and its results."""

from __future__ import annotations

import asyncio
import os
import sys
import uuid
from collections.abc import AsyncIterator, Mapping
from contextlib import closing, suppress
from datetime import datetime, timezone
from operator import attrgetter
from typing import Any, cast

from ballpiston.connection import Connection
from ballpiston.errors import Error, NotFound, facts_of, text_of
from ballpiston.fields import shown, spelled, value_of
from ballpiston.parameter_lists import truth_value
from ballpiston.progress import fraction_of, progress_on_screen
from ballpiston.result import Result
from ballpiston.specification import set_target
from ballpiston.table import html_table
from ballpiston.v1 import ensemble_pb2, spec_pb2
from ballpiston.watch import Attachments, Update, has_ended, watch_job, watch_updates

_PAGE = 1000
_GLANCE_SECONDS = 2.0  # for a notebook that shows a job


def check_labels(labels: Mapping[str, str] | None) -> Mapping[str, str] | None:
    """The same labels. TypeError unless they are texts."""
    if not isinstance(labels or {}, Mapping):
        raise TypeError(f'labels have to be a dict of texts like {{"run": "7"}}, not {labels!r}')
    for key, value in (labels or {}).items():
        if not (isinstance(key, str) and isinstance(value, str)):
            raise TypeError(f'labels: {key!r}: {value!r} is not a pair of texts like "run": "7"')
    return labels


class JobNotSucceeded(Error):
    """The job that was watched ended without success. Its finished points stay:
    `error.job.result()`. The error arrives in another process without `job`."""

    job: Job

    def __reduce__(self) -> tuple[Any, ...]:
        state = {name: value for name, value in vars(self).items() if name != "job"}
        return type(self), self.args, state


class JobFailed(JobNotSucceeded):
    """The job that was watched has failed; the message says why."""


class JobCancelled(JobNotSucceeded):
    """The job that was watched has been cancelled."""


class Job:
    """A job. `client.submit` and `client.job` make these objects; they hold no result.

    The properties have the values of the server's last answer. Only `state` asks the server each
    time, until the job has ended. `refresh()` asks the server and updates all properties.

    Attributes:
        message: the message ballpiston.v1.EnsembleJob, as last seen.
        answered_from_store: whether this job existed before it was submitted, and answered the same
            question. The server says so in the answer to the submission only.
    """

    def __init__(self, connection: Connection, message: Any) -> None:
        self._connection = connection
        self.message = message
        self.answered_from_store = bool(message.answered_from_store)

    name = shown(
        lambda job: str(job.name), "The name with which client.job(name) finds the job again."
    )
    specification = shown(attrgetter("spec"), "The question, for client.submit.")
    experiment = shown(lambda job: spelled(job.spec, "experiment"), 'Such as "first-hit".')
    progress = shown(
        lambda job: fraction_of(job.progress), "The share of the work that is done, 0 to 1."
    )
    error = shown(
        lambda job: text_of(job.error.message, facts_of(job.error)),
        "Why it failed; empty if it did not.",
    )
    pinned = shown(lambda job: bool(job.pinned), "Whether its results do not expire.")
    labels: dict[str, str] = shown(
        lambda job: dict(job.labels), "Short texts by which `client.jobs(labels=...)` finds it."
    )
    created = shown(lambda job: _time(job, "create_time"), "When the server accepted it, in UTC.")
    started = shown(lambda job: _time(job, "start_time"), "When a worker began it, or None.")
    ended = shown(lambda job: _time(job, "end_time"), "When it ended, or None.")
    continues = shown(
        lambda job: str(job.continues), "The name of the job whose points it continues, or empty."
    )

    @property
    def state(self) -> str:
        """Now: "queued", "running", "cancelling", "succeeded", "failed" or "cancelled"."""
        if not has_ended(self.message.state):
            self.refresh()
        return spelled(self.message, "state")

    @property
    def has_ended(self) -> bool:
        """Whether it has succeeded, failed or been cancelled by now."""
        return self.state in ("succeeded", "failed", "cancelled")

    def refresh(self) -> Job:
        """Asks the server for the job as it is now."""
        self.message = self._connection.call(ensemble_pb2.GetEnsembleJobRequest(name=self.name))
        return self

    def watch(self, progress: bool | str = True) -> Result:
        """Waits until the job has ended and returns its result.

        A bar shows the progress in a terminal (on standard error) and in a notebook. The watch goes
        on through restarts of the server. Ctrl-C ends the watch and leaves the job running; a
        message says how to watch it again.

        Args:
            progress: False shows nothing, "bar" shows the bar without a terminal too, "json"
                writes lines of JSON to standard error.

        Raises:
            JobFailed: the job failed; the exception says why.
            JobCancelled: somebody cancelled it.
            Unavailable: the server did not answer for two minutes. The job goes on.
            ResourceExhausted: the server was busy for two minutes. The job goes on.
        """
        screen = progress_on_screen(progress)
        if self.answered_from_store:
            when = f", computed {self.ended:%Y-%m-%d %H:%M} UTC" if self.ended else ""
            screen.note(f"answered from the store: {self.name}{when} (fresh=True computes anew)")
        try:
            with closing(screen):
                self._end(watch_job(self._connection, Attachments(self.name), screen))
        except KeyboardInterrupt:
            print(_farewell(self), file=sys.stderr)
            raise
        except Error as error:
            if not isinstance(error, NotFound):
                error.args = (f"{error}\n{_farewell(self)}",)
            raise
        self._raise_unless_succeeded()
        return self.result()

    def extend(
        self,
        *,
        samples: float | None = None,
        collisions: float | None = None,
        tolerance: float | None = None,
    ) -> Job:
        """Asks the same question with more samples or collisions, or a smaller tolerance. The new
        job continues this one if it has succeeded: it computes only the difference, and its result
        has the bytes of one long run. Raises TypeError: not exactly one of samples, collisions and
        tolerance is given."""
        if samples is collisions is tolerance is None:
            raise TypeError("extend needs a target: give samples, collisions or tolerance")
        spec = spec_pb2.EnsembleSpec()
        spec.CopyFrom(self.refresh().specification)
        spec.target.CopyFrom(type(spec.target)(estimate=spec.target.estimate))
        set_target(spec, samples=samples, collisions=collisions, tolerance=tolerance)
        request = ensemble_pb2.CreateEnsembleJobRequest(
            spec=spec,
            request_id=str(uuid.uuid4()),
            labels=self.labels,
            priority=self.message.priority,
        )
        return Job(self._connection, self._connection.call(request))

    async def updates(self) -> AsyncIterator[Update]:
        """What changes until the job has ended, for an event loop: the wait needs no thread. Raises
        Unavailable, ResourceExhausted: as `watch`."""
        watch = Attachments(self.name)
        async for update in watch_updates(self._connection, watch):
            yield update
        self._end(watch.ended)

    async def result_async(self) -> Result:
        """`watch` for an event loop, without a bar. Raises JobFailed, JobCancelled, Unavailable,
        ResourceExhausted: as `watch`."""
        async for _ in self.updates():
            pass
        self._raise_unless_succeeded()
        return await asyncio.to_thread(self.result)

    def result(self) -> Result:
        """The points that are finished now. It does not wait. Raises ResultsExpired."""
        self.refresh()
        return self.result_in(ensemble_pb2.ListResultsRequest.FULL)

    def result_in(self, view: Any) -> Result:
        """`result` of the job as last seen, in a view of the protocol: BASIC has no histograms or
        curves."""
        self.message.answered_from_store = self.answered_from_store
        request = ensemble_pb2.ListResultsRequest(parent=self.name, page_size=_PAGE, view=view)
        points = [point for page in self._connection.pages(request) for point in page.results]
        for point in points:
            point.ClearField("name")  # as in files: equal answers are equal results
        return Result(self.message, points)

    def cancel(self) -> Job:
        """Stops the job. Its finished points stay. Raises FailedPrecondition: it has already
        succeeded or failed (reason JOB_ALREADY_ENDED)."""
        key = str(uuid.uuid4())
        request = ensemble_pb2.CancelEnsembleJobRequest(name=self.name, request_id=key)
        self.message = self._connection.call(request)
        return self

    def pin(self, pinned: bool = True) -> Job:
        """Keeps its results from expiring; with False they may expire again."""
        return self._update(pinned=truth_value("pinned", pinned))

    def label(self, **labels: str | None) -> Job:
        """Sets these labels and keeps the others; None removes a label. Of two changes at the same
        time the later one may undo the other."""
        kept = {k: v for k, v in (self.refresh().labels | labels).items() if v is not None}
        return self._update(labels=check_labels(kept))

    def delete(self) -> None:
        """Deletes the job with its results. It is not retried: if the answer was lost
        (Unavailable), the job may have been deleted. Raises FailedPrecondition: it has not ended
        (reason JOB_STILL_ACTIVE)."""
        if self._connection.private is not None:
            self._connection.revive()
        self._connection.call_once(ensemble_pb2.DeleteEnsembleJobRequest(name=self.name))

    def __repr__(self) -> str:
        progress = self.message.progress
        return (
            f"<job {self.name}: {self.experiment}, {spelled(self.message, 'state')}, "
            f"{progress.points_done} of {progress.points} points>"
        )

    def _repr_html_(self) -> str:
        request = ensemble_pb2.GetEnsembleJobRequest(name=self.name)
        with suppress(Error, ValueError):  # the server does not answer, or the connection is closed
            self.message = self._connection.call_once(request, _GLANCE_SECONDS)
        progress = self.message.progress
        facts = {
            "experiment": self.experiment,
            "state": spelled(self.message, "state"),
            "points": f"{progress.points_done} of {progress.points}",
            "progress": f"{100 * self.progress:.0f} %",
            "error": self.error,
        }
        known = {name: fact for name, fact in facts.items() if fact}
        return html_table(f"job {self.name}", known, [known.values()])

    def _update(self, **fields: Any) -> Job:
        job, mask = ensemble_pb2.EnsembleJob(name=self.name, **fields), {"paths": list(fields)}
        request = ensemble_pb2.UpdateEnsembleJobRequest(job=job, update_mask=mask)
        self.message = self._connection.call(request)
        return self

    def _end(self, job: Any) -> None:
        """Stores the job of a watch's last message. That message has no grid, so the known
        specification is kept."""
        job.spec.CopyFrom(self.message.spec)
        self.message = job

    def _raise_unless_succeeded(self) -> None:
        state = spelled(self.message, "state")
        if state == "succeeded":
            return
        error_class: type[JobNotSucceeded] = JobCancelled if state == "cancelled" else JobFailed
        status = self.message.error
        text = f"{self.name} {state}" + (f": {status.message}" if status.message else "")
        facts = facts_of(status)
        error = error_class(text_of(text, facts), **facts)
        error.job = self
        raise error


def _time(job: Any, field: str) -> datetime | None:
    time = value_of(job, field)
    return None if time is None else cast(datetime, time.ToDatetime(timezone.utc))


def _farewell(job: Job) -> str:
    words = 'client.job("{0}").{1}()'
    if os.environ.get("BALLPISTON_CONFIG") == "/dev/null":  # by `ballpiston figure`, in a shell
        words = "ballpiston {1} {0}{2}"
    server = "" if job._connection.private else f" --server {job._connection.address}"
    watch, cancel = (words.format(job.name, verb, server) for verb in ("watch", "cancel"))
    return f"The job goes on.\n  watch it again:  {watch}\n  cancel it:       {cancel}"
