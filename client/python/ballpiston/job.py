"""A job on a server: one question, its progress and its results."""

from __future__ import annotations

import asyncio
import os
import sys
import uuid
from collections.abc import AsyncIterator, Mapping
from datetime import datetime, timezone
from typing import Any

from ballpiston.async_watch import Update, watch_updates
from ballpiston.connection import Connection
from ballpiston.error_details import details_of, error_of
from ballpiston.errors import Error, NotFound, ResultsExpired
from ballpiston.fields import value_of
from ballpiston.progress import Progress, fraction_of, progress_on_screen
from ballpiston.result import Result
from ballpiston.result_table import html_table
from ballpiston.specification import set_target
from ballpiston.spelling import spelled
from ballpiston.v1 import ensemble_pb2, spec_pb2
from ballpiston.watch import has_ended, watch_job

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
    """

    def __init__(self, connection: Connection, message: Any) -> None:
        self._connection = connection
        self.message = message
        # The server says so in the answer to the submission only.
        self._is_from_store = bool(message.answered_from_store)

    # ---- properties ----

    @property
    def name(self) -> str:
        """ensembleJobs/ID: with it `client.job(name)` finds the job again, also from another
        process."""
        return str(self.message.name)

    @property
    def specification(self) -> Any:
        """The question, as the message ballpiston.v1.EnsembleSpec; client.submit accepts it."""
        return self.message.spec

    @property
    def experiment(self) -> str:
        """Such as "first-hit"."""
        return spelled(self.message.spec, "experiment")

    @property
    def state(self) -> str:
        """Now: "queued", "running", "cancelling", "succeeded", "failed" or "cancelled"."""
        if not has_ended(self.message.state):
            self.refresh()
        return self._last_state()

    @property
    def has_ended(self) -> bool:
        """Whether it has succeeded, failed or been cancelled by now."""
        return self.state in ("succeeded", "failed", "cancelled")

    @property
    def progress(self) -> float:
        """The share of the work that was done when the server was last asked, 0 to 1."""
        return fraction_of(self.message.progress)

    @property
    def error(self) -> str:
        """Why it failed; empty if it did not."""
        error = self.message.error
        return details_of(error).text(error.message) if self.message.HasField("error") else ""

    @property
    def answered_from_store(self) -> bool:
        """Whether this job existed before it was submitted, and answered the same question."""
        return self._is_from_store

    @property
    def pinned(self) -> bool:
        """Whether its results do not expire."""
        return bool(self.message.pinned)

    @property
    def labels(self) -> dict[str, str]:
        """Short texts by which `client.jobs(labels=...)` finds it."""
        return dict(self.message.labels)

    @property
    def created(self) -> datetime | None:
        """When the server accepted it, in UTC."""
        return self._time("create_time")

    @property
    def started(self) -> datetime | None:
        """When a worker began it; None before that."""
        return self._time("start_time")

    @property
    def ended(self) -> datetime | None:
        """When it ended; None before that."""
        return self._time("end_time")

    @property
    def continues(self) -> str:
        """The name of the job whose points it continues, or empty."""
        return str(self.message.continues)

    # ---- actions ----

    def refresh(self) -> Job:
        """Asks the server for the job as it is now."""
        self.message = self._call(ensemble_pb2.GetEnsembleJobRequest(name=self.name))
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
        if self.answered_from_store and screen.is_visible:
            screen.note(_from_store_text(self))
        try:
            self._follow(screen)
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
        has the bytes of one long run.

        Example:
            >>> more = client.job(name).extend(samples=1e7)
            >>> more.continues, more.watch()

        Raises:
            TypeError: not exactly one of samples, collisions and tolerance is given.
        """
        if samples is collisions is tolerance is None:
            raise TypeError("extend needs a target: give samples, collisions or tolerance")
        spec = spec_pb2.EnsembleSpec()
        spec.CopyFrom(self.refresh().specification)
        estimate = spec.target.estimate
        spec.target.Clear()
        spec.target.estimate = estimate
        set_target(spec, samples, collisions, tolerance, None)
        request = ensemble_pb2.CreateEnsembleJobRequest(
            spec=spec, request_id=str(uuid.uuid4()), labels=self.labels
        )
        return Job(self._connection, self._call(request))

    async def updates(self) -> AsyncIterator[Update]:
        """What changes until the job has ended, for an event loop: the wait needs no thread.

        Example:
            >>> async for update in job.updates():
            ...     print(update.state, update.progress)

        Raises:
            Unavailable: the server did not answer for two minutes. The job goes on.
            ResourceExhausted: the server was busy for two minutes. The job goes on.
        """
        async for update in watch_updates(self._connection, self.name):
            if isinstance(update, Update):
                yield update
            else:
                self._end(update)

    async def result_async(self) -> Result:
        """`watch` for an event loop, without a bar.

        Example:
            >>> results = await asyncio.gather(*(job.result_async() for job in jobs))

        Raises:
            JobFailed, JobCancelled, Unavailable, ResourceExhausted: as `watch`.
        """
        async for _ in self.updates():
            pass
        self._raise_unless_succeeded()
        return await asyncio.to_thread(self.result)

    def result(self) -> Result:
        """The points that are finished now. It does not wait.

        Raises:
            ResultsExpired: the server keeps only the specification:
                `client.run(job.specification)` computes the same results again.
        """
        return self.result_in(ensemble_pb2.ListResultsRequest.FULL)

    def result_in(self, view: Any) -> Result:
        """`result` in a view of the protocol: BASIC has no histograms or curves."""
        self.refresh()
        self.message.answered_from_store = self._is_from_store
        request = ensemble_pb2.ListResultsRequest(parent=self.name, page_size=_PAGE, view=view)
        points: list[Any] = []
        while True:
            page = self._call(request)
            for point in page.results:
                point.ClearField("name")  # as in files: equal answers are equal results
                points.append(point)
            request.page_token = page.next_page_token
            if not request.page_token:
                return Result(self.message, points)

    def cancel(self) -> Job:
        """Stops the job. Its finished points stay.

        Raises:
            FailedPrecondition: it has already succeeded or failed (reason JOB_ALREADY_ENDED).
        """
        request = ensemble_pb2.CancelEnsembleJobRequest(
            name=self.name, request_id=str(uuid.uuid4())
        )
        self.message = self._call(request)
        return self

    def pin(self, pinned: bool = True) -> Job:
        """Keeps its results from expiring; with False they may expire again."""
        return self._update(pinned=pinned)

    def label(self, **labels: str | None) -> Job:
        """Sets these labels and keeps the others; None removes a label. Of two changes at the same
        time the later one may undo the other.

        Example:
            >>> job.label(run="7", who=None)
        """
        kept = {k: v for k, v in (self.refresh().labels | labels).items() if v is not None}
        return self._update(labels=check_labels(kept))

    def delete(self) -> None:
        """Deletes the job with its results. It is not retried: if the answer was lost
        (Unavailable), the job may have been deleted.

        Raises:
            FailedPrecondition: it has not ended (reason JOB_STILL_ACTIVE).
        """
        if self._connection.private is not None:
            self._connection.revive()
        self._connection.call_once(ensemble_pb2.DeleteEnsembleJobRequest(name=self.name))

    # How it looks

    def __repr__(self) -> str:
        progress = self.message.progress
        return (
            f"<job {self.name}: {self.experiment}, {self._last_state()}, "
            f"{progress.points_done} of {progress.points} points>"
        )

    def _repr_html_(self) -> str:
        self._glance()
        progress = self.message.progress
        facts = {
            "experiment": self.experiment,
            "state": self._last_state(),
            "points": f"{progress.points_done} of {progress.points}",
            "progress": f"{100 * self.progress:.0f} %",
            "error": self.error,
        }
        known = {name: fact for name, fact in facts.items() if fact}
        return html_table(f"job {self.name}", known, [known.values()])

    def _glance(self) -> None:
        """Updates the job if the server answers at once; a private server is not started for it."""
        request = ensemble_pb2.GetEnsembleJobRequest(name=self.name)
        try:
            self.message = self._connection.call_once(request, _GLANCE_SECONDS)
        except Error:
            pass

    def _last_state(self) -> str:
        return spelled(self.message, "state")

    def _call(self, request: Any) -> Any:
        try:
            return self._connection.call(request)
        except ResultsExpired as error:
            error.args = (f"{error}\nTo compute them again: client.run(job.specification)",)
            raise

    def _update(self, **fields: Any) -> Job:
        request = ensemble_pb2.UpdateEnsembleJobRequest(
            job=ensemble_pb2.EnsembleJob(name=self.name, **fields),
            update_mask={"paths": list(fields)},
        )
        self.message = self._call(request)
        return self

    def _follow(self, screen: Progress) -> None:
        try:
            self._end(watch_job(self._connection, self.name, screen))
        finally:
            screen.close()

    def _end(self, job: Any) -> None:
        """Stores the job of a watch's last message. That message has no grid, so the known
        specification is kept."""
        job.spec.CopyFrom(self.message.spec)
        self.message = job

    def _raise_unless_succeeded(self) -> None:
        state = self._last_state()
        if state == "succeeded":
            return
        error_class: type[JobNotSucceeded] = JobCancelled if state == "cancelled" else JobFailed
        status = self.message.error
        text = f"{self.name} {state}" + (f": {status.message}" if status.message else "")
        error = error_of(error_class, text, details_of(status), "")
        error.job = self
        raise error

    def _time(self, field: str) -> datetime | None:
        time = value_of(self.message, field)
        return None if time is None else time.ToDatetime(timezone.utc)


def _farewell(job: Job) -> str:
    words = 'client.job("{0}").{1}()'
    if os.environ.get("BALLPISTON_CONFIG") == "/dev/null":  # by `ballpiston figure`, in a shell
        words = "ballpiston {1} {0}{2}"
    server = "" if job._connection.private else f" --server {job._connection.address}"
    watch, cancel = (words.format(job.name, verb, server) for verb in ("watch", "cancel"))
    return f"The job goes on.\n  watch it again:  {watch}\n  cancel it:       {cancel}"


def _from_store_text(job: Job) -> str:
    when = f", computed {job.ended:%Y-%m-%d %H:%M} UTC" if job.ended else ""
    return f"answered from the store: {job.name}{when} (fresh=True computes anew)"
