"""The client of a server: questions, jobs, closed forms, traces."""

from __future__ import annotations

import sys
import uuid
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy.typing as npt

from ballpiston.closed_forms import ClosedForms
from ballpiston.collisions import Collisions, columns_of, events_of
from ballpiston.connection import Connection
from ballpiston.fields import from_spelling, record_of, shown, spelled
from ballpiston.job import Job, check_labels
from ballpiston.parameter_lists import INT64, UINT64, Numbers, Shapes, number_list
from ballpiston.parameter_lists import real_number, shape_list, truth_value, whole_number
from ballpiston.plan import Plan
from ballpiston.private_server import find_program, private_address
from ballpiston.progress import progress_on_screen
from ballpiston.result import Result
from ballpiston.settings import address_and_security
from ballpiston.specification import question_of, specification, takes_keywords_of
from ballpiston.v1 import analytic_pb2, ensemble_pb2, server_pb2, spec_pb2, trace_pb2

_COLLECTION = "ensembleJobs/"
_PAGE = 1000
_UNLIMITED = 1e9  # seconds
# The keywords that submit and run have beside those of the question.
_JOB_KEYWORDS = ("fresh", "priority", "request_id", "labels", "progress")


def connect(
    address: str | None = None,
    *,
    ca: str | None = None,
    tls: bool | None = None,
    token_file: str | None = None,
    timeout: float = 60.0,
) -> Client:
    """A client of a server.

    Without an address the server is that of the variable BALLPISTON_SERVER, else that of the
    command line's config file, else the private server: it is started if it does not run, keeps its
    answers in ~/.local/state/ballpiston, and stops by itself after a minute without work.

    Args:
        address: "host:port" or "unix:PATH".
        ca: TLS; PEM file of the authority that signed the server's certificate [BALLPISTON_CA].
        tls: TLS; with the authorities of this system [BALLPISTON_TLS=1].
        token_file: file with your token, which other users cannot read [BALLPISTON_TOKEN_FILE, or
            the token itself in BALLPISTON_TOKEN]. A token is sent over TLS or to a loopback address.
        timeout: seconds for each single call, above 0, or math.inf; watches and traces have none.

    If an argument is not given, the variable in brackets is used, else the config file. Over a Unix
    socket, the private server's too, both are ignored.

    Raises:
        ValueError: not an address or not a time, or a file that cannot be used.
        PermissionDenied: other users can read the token file.
        NoPrivateServer: the private server cannot be started.
    """
    arguments = {"address": address, "ca": ca, "tls": tls, "token_file": token_file}
    seconds = real_number("timeout", timeout)
    if not seconds > 0:
        raise ValueError(f"timeout is {timeout!r} s; permitted: above 0, or math.inf")
    bound = seconds if seconds < _UNLIMITED else None
    named, security = address_and_security({k: v for k, v in arguments.items() if v is not None})
    if named:
        return Client(Connection(named, security, None, bound))
    private = find_program()
    return Client(Connection(private_address(private), security, private, bound))


@dataclass(frozen=True)
class ServerStatus:
    """The state of a server.

    Attributes:
        address: of the server, as the client was given it.
        state: "serving", "draining" (no new jobs) or "store-failing" (the disk refuses writes).
        version, engine_version: of the program, and of the part that decides the numbers.
        workers, busy_workers: threads that compute.
        queued_jobs, running_jobs: of all users.
        principal, role: who you are to this server; the role is read, submit or admin.
        limits: of the server by name, 0 for none, such as limits["max_points_per_job"].
        message: everything, as the message ballpiston.v1.ServerStatus.
    """

    address: str
    state: str
    version: str
    engine_version: str
    workers: int
    busy_workers: int
    queued_jobs: int
    running_jobs: int
    principal: str
    role: str
    limits: dict[str, float]
    message: Any = field(repr=False)


class Client:
    """Asks one server. `ballpiston.connect()` makes it.

    It may be shared between threads. As a context manager it closes the connection at the end; jobs
    go on.
    """

    address = shown(lambda of: str(of.address), "host:port or unix:PATH.", "_connection")

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def close(self) -> None:
        """Closes the connection: calls after it raise a ValueError. Jobs go on."""
        self._connection.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<client of {self.address}>"

    @takes_keywords_of(specification)
    def submit(
        self,
        experiment: Any,
        *,
        fresh: bool = False,
        priority: int = 0,
        request_id: str | uuid.UUID | None = None,
        labels: Mapping[str, str] | None = None,
        **question: Any,
    ) -> Job:
        """Asks a question and returns the job at once; it is then on the server's disk.

        A question that was answered before is answered by the job of that time
        (`job.answered_from_store`), unless it has a budget.

        Args:
            experiment: its name, such as "first-hit", with the keywords of
                `ballpiston.specification` (rho, delta, samples, seed, ...); or a whole
                specification, such as `job.specification`.
            fresh: compute, even if the server has stored the answer.
            priority: -100 to 100; of your own jobs those with a higher one run first.
            request_id: a UUID, the idempotency key: a retry with it returns the original job.
            labels: short texts by which `client.jobs(labels=...)` finds the job; they are added to
                those of a job that answers from the store, if none has another value there.

        Raises:
            TypeError: a keyword that does not exist; the message suggests the nearest one.
            InvalidSpecification: wrong values; `violations` lists all of them.
            ResourceExhausted: a limit of the server.
        """
        request = ensemble_pb2.CreateEnsembleJobRequest(
            spec=question_of(experiment, question, _JOB_KEYWORDS),
            request_id=str(request_id or uuid.uuid4()),
            fresh=truth_value("fresh", fresh),
            priority=whole_number("priority", priority, -100, 100),
            labels=check_labels(labels),
        )
        try:
            return Job(self._connection, self._connection.call(request))
        except KeyboardInterrupt:
            print(
                "The server may have accepted the job. With "
                f'request_id="{request.request_id}" the same call returns this job.',
                file=sys.stderr,
            )
            raise

    @takes_keywords_of(submit)
    def run(self, experiment: Any, *, progress: bool | str = True, **question: Any) -> Result:
        """`submit` and `Job.watch` in one: waits for the job and returns its result.

        Args:
            progress: as that of `Job.watch`.
            experiment and all other keywords: as those of `submit`.

        Raises:
            JobFailed, JobCancelled: the job did not succeed; `error.job` is the job.
        """
        progress_on_screen(progress)  # a wrong value is an error before the job is submitted
        return self.submit(experiment, **question).watch(progress=progress)

    @takes_keywords_of(specification)
    def plan(self, experiment: Any, **question: Any) -> Plan:
        """What a question would cost with each model, and which one would answer. Runs nothing."""
        request = ensemble_pb2.PlanEnsembleJobRequest(spec=question_of(experiment, question))
        return Plan(self._connection.call(request))

    def job(self, name: str) -> Job:
        """The job of this name, ensembleJobs/ID or the ID alone. Raises NotFound: there is no such
        job, or it belongs to another user."""
        if not isinstance(name, str):
            raise TypeError(f"name has to be a str, such as job.name, not {name!r}")
        full = name if name.startswith(_COLLECTION) else _COLLECTION + name
        request = ensemble_pb2.GetEnsembleJobRequest(name=full)
        return Job(self._connection, self._connection.call(request))

    def jobs(
        self,
        *,
        state: str | Iterable[str] = (),
        experiment: str | Iterable[str] = (),
        labels: Mapping[str, str] | None = None,
        limit: int | None = None,
    ) -> list[Job]:
        """Your jobs, or those of all users if you are an administrator, the newest first.

        Args:
            state: one or several of "queued", "running", "cancelling", "succeeded", "failed",
                "cancelled"; empty: any.
            experiment: one or several; empty: any.
            labels: only jobs with all of these.
            limit: at most so many; None: all.
        """
        request = ensemble_pb2.ListEnsembleJobsRequest(
            states=_numbers_of(ensemble_pb2.EnsembleJob, "state", state),
            experiments=_numbers_of(spec_pb2.EnsembleSpec, "experiment", experiment),
            labels=check_labels(labels),
        )
        if limit is not None and (limit := whole_number("limit", limit)) < 0:
            raise ValueError(f"limit is {limit}; permitted: 0 or more, or None for all jobs")
        jobs: list[Job] = []
        pages = self._connection.pages(request)
        while limit is None or len(jobs) < limit:
            request.page_size = _PAGE if limit is None else min(_PAGE, limit - len(jobs))
            if (page := next(pages, None)) is None:
                break
            jobs += [Job(self._connection, message) for message in page.jobs]
        return jobs

    def analytic(
        self,
        rho: Numbers,
        delta: Numbers,
        epsilon: Numbers = (),
        *,
        outgoing_epsilon: Numbers = (),
        beta: Numbers = (),
        temperature: Numbers = (),
    ) -> ClosedForms:
        """Closed forms at every pair of rho and delta, at most 10,000 pairs and 100,000 values.
        Samples nothing.

        Args:
            rho, delta: as in a question.
            epsilon: energies of the piston, 0 to 1/2: adds the moments of the kernel and the
                conditional mean free time.
            outgoing_epsilon: energies after the collision, between 0 and 1/2: adds the kernel.
            beta, temperature: 1e-120 to 1e120; adds canonical averages.
        """
        lists = {"rho": rho, "delta": delta, "epsilon": epsilon, "beta": beta}
        lists |= {"outgoing_epsilon": outgoing_epsilon, "temperature": temperature}
        request = analytic_pb2.EvaluatePairsRequest(
            **{name: number_list(name, values) for name, values in lists.items()}
        )
        return ClosedForms(self._connection.call(request))

    def trace(
        self,
        *,
        rho: float,
        delta: float,
        events: float,
        seed: int = 0,
        cells: Shapes | None = None,
        temperature: float | None = None,
    ) -> Iterator[dict[str, Any]]:
        """One orbit of the reference billiard: an iterator of dicts, first the start with all
        bodies, then the events in the order of time.

        The dicts are the lines of `ballpiston trace`: "time", "event" (such as "ball_piston"),
        "free_time", and positions, velocities and energies of the bodies that take part. The
        server computes events only as fast as they are read. The same call gives the same orbit.

        Args:
            rho, delta: of the cell.
            events: how many, 1 to 1,000,000.
            seed: of the random start.
            cells: shape of a periodic gas, such as 8 or "4x3", at most 1,000 cells; None: the pair.
            temperature: of the gas; None: 1.

        Example:
            >>> events = client.trace(rho=0.5296, delta=0.2, events=1000)
            >>> pandas.DataFrame(events).groupby("event")["free_time"].mean()
        """
        orbit = _orbit_request(rho, delta, events, seed, cells, temperature)
        return events_of(self._connection, orbit)

    @takes_keywords_of(trace)
    def trace_arrays(self, *fields: str, **orbit: Any) -> dict[str, npt.NDArray[Any]]:
        """The events of `trace` as arrays, without the start: faster, for long orbits.

        Args:
            fields: of an event, such as "time", "event", "piston_energy"; NaN where absent.
            orbit: all other keywords, as those of `trace`.

        Raises:
            ValueError: an event has no such field.
        """
        return columns_of(self._connection, _orbit_request(**orbit), fields)

    @takes_keywords_of(specification)
    def sample(self, experiment: Any, **question: Any) -> Collisions:
        """The collisions of a point's samples, for observables of one's own: those that `run` with
        the same arguments averages. If there is a closed form, `run` samples only with verify=True.

        Args:
            experiment: one with a ball-piston pair, with the keywords of
                `ballpiston.specification` for one point and a number of samples or collisions; or a
                whole specification.

        Example:
            >>> hits = client.sample("first-hit", rho=0.5296, delta=0.2, epsilon=0.125, exponent=1,
            ...                      samples=1e5).all()
            >>> np.corrcoef(hits["free_time"], hits["y"])
        """
        return Collisions(self._connection, question_of(experiment, question))

    def status(self) -> ServerStatus:
        """What the server is doing and what it permits. The first call to a server takes most of a
        second, because the server measures its speed."""
        message = self._connection.call(server_pb2.GetServerStatusRequest())
        facts = {"address": self.address, "state": spelled(message, "state"), "message": message}
        facts = record_of(message) | {"limits": record_of(message.limits)} | facts
        return ServerStatus(**{fact.name: facts[fact.name] for fact in fields(ServerStatus)})


def _numbers_of(message: Any, field: str, names: str | Iterable[str]) -> list[int]:
    names = [names] if isinstance(names, str) else names
    return [from_spelling(message, field, name) for name in names]


def _orbit_request(
    rho: float,
    delta: float,
    events: float,
    seed: int = 0,
    cells: Shapes | None = None,
    temperature: float | None = None,
) -> Any:
    request = trace_pb2.TraceOrbitRequest(
        rho=real_number("rho", rho),
        delta=real_number("delta", delta),
        events=whole_number("events", events, *INT64),
        seed=whole_number("seed", seed, *UINT64),
    )
    if cells is not None:
        if len(shapes := shape_list("cells", cells)) != 1:
            raise ValueError(f"cells: a trace has one shape, not {len(shapes)}")
        request.cells = shapes[0]
    if temperature is not None:
        request.temperature = real_number("temperature", temperature)
    return request
