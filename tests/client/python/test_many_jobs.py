"""Tables of points, labels, exports, extensions, and watches in an event loop."""

from __future__ import annotations

import asyncio
import csv
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ENDLESS, FIRST_HITS, Home

import ballpiston
from ballpiston.collisions import _records_of
from ballpiston.v1 import ensemble_pb2, trace_pb2

TABLE = {"rho": [0.53, 0.6, 0.55], "delta": [0.1, 0.05, 0.2]}
OF_THE_TABLE = {"epsilon": 0.125, "exponent": 1, "samples": 100}


def hits(seed: int) -> dict[str, Any]:
    """A question of a few milliseconds."""
    return {**FIRST_HITS, "seed": seed}


def test_a_table_may_be_a_frame_or_rows(client: ballpiston.Client) -> None:
    pandas = pytest.importorskip("pandas")
    rows = [{"rho": rho, "delta": delta} for rho, delta in zip(*TABLE.values())]
    asked = [
        ballpiston.specification("first-hit", points=points, **OF_THE_TABLE)
        for points in (TABLE, rows, pandas.DataFrame(TABLE))
    ]
    assert asked[0] == asked[1] == asked[2]
    grid = asked[0].grid
    assert list(grid.table) == ["rho", "delta"]
    assert {"rho": list(grid.rho), "delta": list(grid.delta)} == TABLE
    alone = client.run("first-hit", **rows[2], **OF_THE_TABLE)
    assert client.run(asked[0]).messages[2].estimates == alone.messages[0].estimates


@pytest.mark.parametrize(
    "points, message",
    [
        ({"rho": [0.53], "detla": [0.1]}, "'detla' is not a parameter; did you mean 'delta'?"),
        ([{"rho": 0.53}, {"delta": 0.1}], "row 1: has the keys delta; row 0 has rho"),
        ([{"rho": 0.53}, {"rho": "x"}], "points, column rho has to be a number, not 'x'"),
        ({"rho": 0.53, "delta": [0.1]}, "points, column rho has to be a list, not 0.53"),
        ({"exponent": {0: 5, 1: 9}}, "points, column exponent has to be a list, not {0: 5, 1: 9}"),
        ({"cells": "48"}, "points, column cells has to be a list, not '48'"),
        ({"cells": ["4:8:3"]}, "points, column cells has the range '4:8:3'"),
        ({"rho": [0.53], "epsilon": [0.1]}, "points has the column epsilon, and epsilon is given"),
        ([], "points has no row"),
        (7, "has to be a pandas.DataFrame"),
    ],
)
def test_an_error_of_a_table_names_the_column_or_the_row(points: object, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=re.escape(message)):
        ballpiston.specification("first-hit", points=points, **OF_THE_TABLE)


def test_a_labelled_job_is_found_relabelled_and_selected(
    home: Home, client: ballpiston.Client
) -> None:
    labels = {"run": "found", "who": "pilot"}
    job = client.submit(**hits(101), labels=labels)
    assert job.labels == labels
    other = client.submit(**hits(102), labels={"run": "found"})
    found = client.jobs(labels={"run": "found"})
    assert [j.name for j in found] == [other.name, job.name]
    assert [j.name for j in client.jobs(labels=labels)] == [job.name]
    assert job.label(who=None, day="7").labels == {"run": "found", "day": "7"}
    for labelled in (job, other):
        labelled.watch(progress=False)
    assert home.command("label", job.name, "day=", "a.b=x/y") == f"{job.name} a.b=x/y run=found\n"
    assert home.command("list", "--label", "run=found", "--format", "csv").count("\n") == 3
    assert home.command("watch", "--label", "run=found", "--exec", 'echo "$BALLPISTON_JOB_STATE"')
    assert home.command("result", "--label", "run=found").count("mean_hit_time") == 8
    deleted = home.command("delete", "--label", "run=found", "--yes")
    assert sorted(deleted.split("\n")) == ["", *sorted(f"{j.name} deleted" for j in (job, other))]


def test_a_list_of_many_pages_is_whole(
    client: ballpiston.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("client", "job"):
        monkeypatch.setattr(f"ballpiston.{module}._PAGE", 2)
    question = {**FIRST_HITS, "fresh": True, "labels": {"run": "pages"}}
    jobs = [client.submit(**question) for _ in range(5)]
    assert [point.index for point in jobs[0].watch(progress=False)] == [0, 1, 2, 3]
    sizes: list[int] = []
    call = client._connection.call
    monkeypatch.setattr(
        client._connection, "call", lambda asked: sizes.append(asked.page_size) or call(asked)
    )
    for limit, length in ((None, 5), (1e19, 5), (2, 2), (3, 3)):
        assert len(client.jobs(labels={"run": "pages"}, limit=limit)) == length
    assert sizes[-2:] == [2, 1]


def test_cancel_by_label_cancels_only_after_yes(home: Home, endless: ballpiston.Job) -> None:
    endless.label(run="endless")
    asked = home.run("cancel", "--label", "run=endless", input="n\n")
    assert "cancel 1 job of local? [y/N]" in asked.stderr
    assert "nothing was changed" in asked.stderr
    assert not endless.has_ended
    home.run("cancel", "--label", "run=endless", input="y\n", check=True)
    assert endless.state in ("cancelling", "cancelled")


def test_an_extended_job_has_the_bytes_of_one_long_run(client: ballpiston.Client) -> None:
    question: dict[str, Any] = dict(rho=0.53, delta=[0.1, 0.2], epsilon=0.125, exponent=1, seed=104)
    job = client.submit("first-hit", **question, samples=3_000, priority=-1)
    job.watch(progress=False)
    with pytest.raises(TypeError, match="give samples, collisions or tolerance"):
        job.extend()
    for samples in (20_000, 50_000):
        longer = job.extend(samples=samples)
        assert longer.continues == job.name and longer.message.priority == -1
        extended = longer.watch(progress=False)
        assert set(ballpiston.estimates_table([longer])["continues"]) == {job.name}
        job = longer
    at_once = client.run("first-hit", **question, samples=50_000, fresh=True, progress=False)
    assert [p.message for p in extended] == [p.message for p in at_once]


def test_the_estimates_of_many_jobs_are_one_table(
    home: Home, client: ballpiston.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = [client.submit(**hits(s), labels={"run": "table"}) for s in (106, 107)]
    results = [job.watch(progress=False) for job in jobs]
    listed = client.jobs(labels={"run": "table"})
    with monkeypatch.context() as patch:
        patch.setattr(ballpiston.Job, "refresh", None)  # what the list said is enough
        table = ballpiston.estimates_table(listed)
    basic = jobs[0].result_in(ensemble_pb2.ListResultsRequest.BASIC)
    assert results[0].messages[0].histograms and not basic.messages[0].histograms
    times = table["value"][table["name"] == "mean_hit_time"]
    assert set(times) == {time for result in results for time in result["mean_hit_time"]}
    assert set(table["seed"]) == {"106", "107"} and set(table["labels"]) == {"run=table"}
    assert set(table["principal"]) == {"local"} and set(table["precision"]) == {"double"}

    for ending in ("csv", "npz"):
        out = tmp_path / f"table.{ending}"
        assert home.command("export", "--label", "run=table", "--out", str(out)) == f"{out}\n"
    arrays = np.load(tmp_path / "table.npz")
    for name, column in table.items():
        np.testing.assert_array_equal(arrays[name], column)
    rows = list(csv.DictReader((tmp_path / "table.csv").open()))
    assert [float(row["value"]) for row in rows] == table["value"].tolist()


def test_an_export_without_a_job_or_without_results_fails(
    home: Home, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "none.csv"
    ended = home.run("export", "--label", "zz=1", "--out", str(out))
    assert ended.returncode == 5 and "no job has these labels" in ended.stderr
    assert not out.exists()

    class Expired:
        name, has_ended = "ensembleJobs/old", True

        def result_in(self, view: int) -> None:
            assert view == ensemble_pb2.ListResultsRequest.BASIC
            raise ballpiston.ResultsExpired("the results have expired")

    with pytest.raises(ballpiston.ResultsExpired):
        ballpiston.estimates_table([Expired()])
    assert "ensembleJobs/old is left out" in capsys.readouterr().err


def test_a_table_of_estimates_needs_jobs(first_hits: ballpiston.Result) -> None:
    with pytest.raises(TypeError, match="a list of jobs; one item is a Result"):
        ballpiston.estimates_table([first_hits])  # type: ignore[list-item]


def test_a_table_has_the_state_of_its_points_and_warns_of_lost_orbits(
    client: ballpiston.Client,
    first_hits: ballpiston.Result,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    job = client.job(first_hits.job_name)
    partial = ensemble_pb2.EnsembleJob(state=ensemble_pb2.EnsembleJob.RUNNING)
    lost = ballpiston.Result(partial, job.result().messages)
    lost.messages[2].health.escapes = 3
    job.specification.precision = ballpiston.v1.spec_pb2.EnsembleSpec.SINGLE
    monkeypatch.setattr(job, "result_in", lambda view: lost)
    table = ballpiston.estimates_table([job])
    assert (set(table["state"]), set(table["precision"])) == ({"running"}, {"single"})
    warning = "warning: point 2: 3 orbits left the cell; this is a defect: do not use the point"
    assert f"{job.name}: {warning}\n" in capsys.readouterr().err
    assert repr(lost).endswith(f"\n{warning}") and warning in lost._repr_html_()
    same_index = ballpiston.Result(partial, [lost.messages[2], first_hits.messages[2]])
    assert warning in repr(same_index)


def test_the_estimates_of_a_running_job_have_a_note(
    endless: ballpiston.Job, capsys: pytest.CaptureFixture[str]
) -> None:
    ballpiston.estimates_table([endless])
    assert re.search(r"is still (queued|running): 0 of 1 points", capsys.readouterr().err)


@pytest.mark.parametrize("labels", [{"a": 5}, {5: "a"}, ["a"]])
def test_labels_have_to_be_texts(client: ballpiston.Client, labels: Any) -> None:
    with pytest.raises(TypeError, match="labels.* texts"):
        client.submit(**FIRST_HITS, labels=labels)
    with pytest.raises(TypeError, match="labels.* texts"):
        client.jobs(labels=labels)


def test_an_event_loop_watches_many_jobs(client: ballpiston.Client) -> None:
    jobs = [client.submit(**hits(seed)) for seed in (108, 109, 110)]

    async def watch() -> list[ballpiston.Result]:
        updates = [update async for update in jobs[0].updates()]
        assert updates[-1].state == "succeeded" and updates[-1].progress == 1
        return await asyncio.gather(*(job.result_async() for job in jobs))

    results = asyncio.run(watch())
    for job, result in zip(jobs, results):
        np.testing.assert_array_equal(result["mean_hit_time"], job.result()["mean_hit_time"])
    cancelled = client.submit(**ENDLESS).cancel()
    with pytest.raises(ballpiston.JobCancelled):
        asyncio.run(cancelled.result_async())
    cancelled.delete()
    with pytest.raises(ballpiston.NotFound):
        asyncio.run(cancelled.result_async())


def test_the_collisions_of_a_job_are_read_as_records(
    home: Home, client: ballpiston.Client, tmp_path: Path
) -> None:
    words = "first-hit --rho 0.53 --delta 0.2 --epsilon 0.125 --exponent 1 --samples 5000".split()
    question: dict[str, Any] = dict(rho=0.53, delta=0.2, epsilon=0.125, exponent=1)
    records = client.sample("first-hit", **question, samples=5_000, verify=True).all()
    result = client.run("first-hit", **question, samples=5_000, progress=False)
    parts = client.sample("first-hit", **question, samples=5_000)
    assert sum(map(len, parts)) == 5_000
    parts.close()
    assert list(parts) == []
    assert records["sample"].tolist() == list(range(5_000))
    assert records["time"].mean() == pytest.approx(result["mean_hit_time"][0], rel=1e-12)
    np.testing.assert_allclose(records["ball_vx_after"], records["piston_vx"], atol=1e-14)

    for ending in ("csv", "npz"):
        out = tmp_path / f"hits.{ending}"
        assert home.command("sample", *words, "--out", str(out)) == f"{out}\n"
    arrays = np.load(tmp_path / "hits.npz")
    assert all(part.compress_size == part.file_size for part in arrays.zip.infolist())
    read = np.genfromtxt(tmp_path / "hits.csv", delimiter=",", names=True)
    for name in records.dtype.names:
        np.testing.assert_array_equal(arrays[name], records[name])
        np.testing.assert_array_equal(read[name], records[name])


def test_a_column_that_the_server_does_not_send_is_nan() -> None:
    assert np.isnan(_records_of(trace_pb2.SampleCollisionsResponse(sample=[0, 1]))["time"]).all()


def test_collisions_become_a_file_of_columns(
    client: ballpiston.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is a pickle, because pyarrow is not a package of Debian."""
    pandas = pytest.importorskip("pandas")
    question: dict[str, Any] = dict(rho=0.53, delta=0.2, epsilon=0.125, exponent=1, samples=2_000)
    hits = client.sample("first-hit", **question)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ModuleNotFoundError):
        hits.to_parquet(tmp_path / "hits.parquet")
    assert not list(tmp_path.iterdir())
    monkeypatch.setitem(sys.modules, "pyarrow", pandas)
    to_pickle = lambda frame, path, index: frame.to_pickle(path, compression=None)
    monkeypatch.setattr(pandas.DataFrame, "to_parquet", to_pickle)
    hits.to_parquet(tmp_path / "hits.parquet")
    frame = pandas.read_pickle(tmp_path / "hits.parquet", compression=None)
    records = client.sample("first-hit", **question).all()
    assert list(frame) == list(records.dtype.names)
    assert len(frame) == 2_000
    for name in frame:
        np.testing.assert_array_equal(frame[name], records[name])
