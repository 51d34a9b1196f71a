"""Jobs on a real server: submitted, watched, listed, cancelled, pinned, deleted."""

from __future__ import annotations

import pickle
import uuid
from typing import Any

import numpy as np
import pytest
from conftest import ENDLESS, FIRST_HITS, LIMIT, Home, wait_until

import ballpiston


def test_the_life_of_a_job(client: ballpiston.Client) -> None:
    identifier = uuid.uuid4()
    job = client.submit(**FIRST_HITS, fresh=True, request_id=identifier)
    assert client.submit(**FIRST_HITS, fresh=True, request_id=str(identifier)).name == job.name
    for name in (job.name, job.name.removeprefix("ensembleJobs/")):
        assert client.job(name).name == job.name
    with pytest.raises(TypeError, match="name has to be a str, such as job.name, not 3"):
        client.job(3)  # type: ignore[arg-type]
    result = job.watch()
    assert client.job(job.name).result() == result
    assert (job.state, job.has_ended) == ("succeeded", True)
    assert (len(result), result.job_name) == (4, job.name)
    assert job.created <= job.started <= job.ended
    again = client.run(result.specification, fresh=True)
    assert again.job_name != job.name
    np.testing.assert_array_equal(again["mean_hit_time"], result["mean_hit_time"])
    assert job.pin().pinned
    with pytest.raises(TypeError, match="pinned has to be True or False, not None"):
        job.pin(None)  # type: ignore[arg-type]
    assert not job.pin(False).pinned
    job.delete()
    for call in (job.watch, job.refresh, lambda: client.job(job.name)):
        with pytest.raises(ballpiston.NotFound) as caught:
            call()
        assert caught.value.reason == "JOB_NOT_FOUND" and "goes on" not in str(caught.value)


def test_the_same_question_is_answered_from_the_store(client: ballpiston.Client) -> None:
    question: Any = dict(experiment="equilibrium", rho=0.53, delta=0.1, model="billiard", samples=9)
    first = client.run(**question)
    job = client.submit(**question)
    assert job.answered_from_store
    assert job.name == first.job_name
    assert job.watch().job.answered_from_store
    again = client.submit(**question, fresh=True)
    assert not again.answered_from_store
    assert again.name != job.name
    again.watch()  # the next test lists active jobs


def test_jobs_are_listed_by_state_and_experiment(
    client: ballpiston.Client, endless: ballpiston.Job
) -> None:
    client.run(**FIRST_HITS)
    names = [job.name for job in client.jobs(state=["queued", "running"])]
    assert names == [endless.name]
    succeeded = client.jobs(state="succeeded", experiment="first-hit", limit=None)
    assert succeeded and all(job.experiment == "first-hit" for job in succeeded)
    assert len(client.jobs(limit=1)) == 1
    assert client.jobs(limit=0) == []
    with pytest.raises(ValueError, match="limit has to be a whole number, not 1.5"):
        client.jobs(limit=1.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="limit is -1; permitted: 0 or more, or None"):
        client.jobs(limit=-1)


def test_a_cancelled_job_keeps_its_finished_points(
    client: ballpiston.Client, endless: ballpiston.Job
) -> None:
    endless.cancel()
    with pytest.raises(ballpiston.JobCancelled, match="cancelled") as caught:
        endless.watch()
    assert caught.value.job is endless
    assert list(endless.specification.grid.rho)
    assert len(endless.result()) == 0
    caught.value.metadata["limit"] = "3"
    error = pickle.loads(pickle.dumps(caught.value))  # as it reaches another process
    assert type(error) is ballpiston.JobCancelled
    assert str(error) == f"{endless.name} cancelled"
    assert error.metadata == {"limit": "3"} and not hasattr(error, "job")


def test_a_notebook_shows_the_job_as_it_is_now(endless: ballpiston.Job) -> None:
    wait_until(lambda: "running" in endless._repr_html_())
    assert endless.name in repr(endless)


def test_a_call_after_the_server_was_killed_starts_it_again(own_home: Home) -> None:
    with ballpiston.connect(timeout=LIMIT) as client:
        job = client.submit(**ENDLESS)
        before = own_home.server_id()
        own_home.end_server(9)
        assert client.job(job.name).state in ("queued", "running")
        assert own_home.server_id() != before
        own_home.end_server(9)
        job.cancel()
        wait_until(lambda: job.has_ended)
        events = client.trace(rho=0.5296, delta=0.1, events=1e6)
        next(events)
        own_home.end_server(9)
        with pytest.raises(
            ballpiston.Unavailable, match="no answer from the server at unix:"
        ) as caught:
            list(events)
        assert "another user" not in str(caught.value)
        job.delete()
        assert client.jobs() == []
