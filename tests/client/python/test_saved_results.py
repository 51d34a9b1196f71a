"""Results in files, and that they are those of the command line."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import LIMIT, Home
from google.protobuf import json_format

import ballpiston
from ballpiston.command import exit_code_of
from ballpiston.whole_file import write_atomically


def test_a_result_is_equal_after_it_was_saved_and_loaded_without_a_server(
    first_hits: ballpiston.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BALLPISTON_PROGRAM", "/does/not/exist")
    first_hits.save(tmp_path / "saved.json")
    loaded = ballpiston.load(tmp_path / "saved.json")
    assert loaded == first_hits
    assert loaded.specification == first_hits.specification
    loaded.messages[0].estimates[0].value += 1e-9
    assert loaded != first_hits


def test_the_saved_document_is_that_of_the_command_line_bit_for_bit(
    first_hits: ballpiston.Result, home: Home, tmp_path: Path
) -> None:
    first_hits.save(tmp_path / "saved.json")
    saved = json.loads((tmp_path / "saved.json").read_text())
    assert saved.pop("client_version") == ballpiston.__version__
    text = home.command("result", first_hits.job_name, "--format", "json")
    printed = json.loads(text)
    assert printed.pop("client_version")
    assert saved == printed
    (tmp_path / "printed.json").write_text(text)
    assert ballpiston.load(tmp_path / "printed.json") == first_hits


def test_arrays_need_a_regular_file(home: Home, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.npz")
    refused = home.run("result", "ensembleJobs/none", "--save", str(tmp_path / "pipe.npz"))
    assert refused.returncode == 2 and "is not a regular file" in refused.stderr


@pytest.mark.parametrize("end,code", [("kill $PPID; sleep 60; echo late", 130), ("exit 1", 2)])
def test_a_conversion_to_arrays_that_does_not_end_keeps_the_previous_file(
    end: str,
    code: int,
    home: Home,
    first_hits: ballpiston.Result,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    python, saved = tmp_path / "python3", tmp_path / "saved.npz"
    python.write_text(f'#!/bin/sh\n[ "$1" = -c ] || {{ {end}; }}\n')
    python.chmod(0o700)
    monkeypatch.setenv("BALLPISTON_PYTHON", str(python))
    saved.write_text("before")
    # Returns when no process has the standard output any more.
    client = home.run("result", first_hits.job_name, "--save", str(saved))
    assert (client.returncode, client.stdout) == (code, "")
    assert sorted(tmp_path.iterdir()) == [python, saved]
    assert saved.read_text() == "before"


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_full_disk_is_an_error_that_names_the_file(
    ending: str, home: Home, tmp_path: Path
) -> None:
    program = (
        "import resource, sys, numpy\n"
        "from pathlib import Path\n"
        "from ballpiston.command import run_program\n"
        "from ballpiston.table import write_table\n"
        "table = {'n': numpy.random.default_rng(1).random(1000)}\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "sys.exit(run_program(lambda words: write_table(Path(words[0]), table), sys.argv[1:]))"
    )
    file = tmp_path / f"table.{ending}"
    writer = home.python(program, str(file))
    assert writer.communicate(timeout=LIMIT) == ("", f"ballpiston: {file}: File too large\n")
    assert writer.returncode == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("reason,delay,code", [("SIZE", 0.0, 2), ("LOAD", 9.0, 3), ("", 0.0, 4)])
def test_a_program_says_by_its_exit_code_whether_a_retry_helps(
    reason: str, delay: float, code: int
) -> None:
    limit = ballpiston.ResourceExhausted("a limit", reason=reason, retry_delay=delay)
    assert exit_code_of(limit) == code
    not_started = ballpiston.NoPrivateServer("a store of another version")
    assert exit_code_of(not_started) == 3
    not_started.exit_code = code
    assert exit_code_of(not_started) == code


def program(result: str) -> str:
    return (
        "import pathlib, signal, sys\n"
        "from ballpiston.command import run_program\n"
        f"sys.exit(run_program(lambda _: {result}, []))"
    )


def test_sigterm_interrupts_a_program_without_a_traceback(home: Home) -> None:
    interrupted = home.python(program("signal.raise_signal(signal.SIGTERM) or []"))
    assert interrupted.communicate(timeout=LIMIT) == ("", "")
    assert interrupted.returncode == 130


PRINTER = program(r"[pathlib.Path('\xfc')]")


def test_a_program_prints_names_of_files_that_its_encoding_cannot_spell(home: Home) -> None:
    printer = home.python(PRINTER, env=os.environ | {"PYTHONIOENCODING": "ascii"})
    assert printer.communicate(timeout=LIMIT) == ("ü\n", "")


@pytest.mark.parametrize(
    "out,code,why",
    [(">/dev/full", 2, "No space left"), (">&-", 2, "Bad file descriptor"), ("| true", 0, "")],
)
def test_a_full_disk_or_closed_output_is_an_error_and_a_closed_pipe_is_none(
    out: str, code: int, why: str
) -> None:
    shell = f'"$0" -c "$1" {out}; exit ${{PIPESTATUS[0]}}'
    command = ["bash", "-c", shell, sys.executable, PRINTER]
    buffered = os.environ | {"PYTHONUNBUFFERED": ""}
    printer = subprocess.run(command, capture_output=True, text=True, env=buffered, timeout=LIMIT)
    assert (printer.returncode, bool(printer.stderr)) == (code, bool(why))
    assert why in printer.stderr


@pytest.mark.parametrize("is_command", [False, True])
def test_an_archive_has_the_arrays_of_the_result(
    is_command: bool, home: Home, first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    saved = tmp_path / "saved.npz"
    if is_command:
        home.command("result", first_hits.job_name, "--save", str(saved))
    else:
        first_hits.save(saved)
    arrays = first_hits.arrays()
    with np.load(saved) as archive:
        assert set(archive) == set(arrays)
        for name, array in arrays.items():
            np.testing.assert_array_equal(archive[name], array)
        provenance = json.loads(str(archive["provenance"]))
    assert provenance["job"] == first_hits.job_name
    assert provenance["client_version"] == ballpiston.__version__
    assert provenance["spec"]["seed"] == "7"
    with pytest.raises(ValueError, match="numpy.load reads it"):
        ballpiston.load(saved)
    with pytest.raises(ValueError, match=".json or .npz"):
        first_hits.save(tmp_path / "saved.csv")
    assert list(tmp_path.iterdir()) == [saved]


def test_an_archive_has_the_names_and_shapes_of_its_layout(first_hits: ballpiston.Result) -> None:
    arrays = first_hits.arrays()
    assert arrays["index"].tolist() == [0, 1, 2, 3]
    assert arrays["model"].tolist() == ["billiard"] * 4
    assert arrays["mean_hit_time_exact"].shape == (4,)
    for sign, suffix in ((+1, "plus"), (-1, "minus")):
        histogram = first_hits.histogram("alpha", sigma=sign, point=2)
        name = f"histogram_alpha_{suffix}"
        assert arrays[f"{name}_counts"][2].tolist() == histogram.counts.tolist()
        assert arrays[f"{name}_expected"][2].tolist() == histogram.expected.tolist()
        assert arrays[f"{name}_upper"][2] == pytest.approx(histogram.edges[-1])
    assert arrays["curve_survival_time"].shape == arrays["curve_survival_value"].shape
    assert arrays["health_escapes"].tolist() == [0, 0, 0, 0]
    assert arrays["kl_divergence_cells"].shape == (4,)


def test_a_document_of_another_program_can_be_loaded(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    """With names in lowerCamelCase, 64-bit integers as strings, a value without a number, and a
    field of a later version."""
    first_hits.save(tmp_path / "saved.json")
    document = json.loads((tmp_path / "saved.json").read_text())
    document["job"] = json_format.MessageToDict(first_hits.job)
    document["points"] = [json_format.MessageToDict(message) for message in first_hits.messages]
    estimate = document["points"][0]["estimates"][0]
    assert isinstance(document["job"]["spec"]["target"]["samples"], str)
    assert "standardError" in estimate
    value, estimate["value"] = estimate["value"], "NaN"
    document["points"][0]["of_a_later_version"] = 1
    (tmp_path / "other.json").write_text(json.dumps(document))
    loaded = ballpiston.load(tmp_path / "other.json")
    assert math.isnan(loaded.messages[0].estimates[0].value)
    loaded.messages[0].estimates[0].value = value
    assert loaded == first_hits


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"job": 1}',
        '{"job": {"spec": {"seed": 1.5}}, "points": []}',
        '{"job": {}, "points": [{"estimates": 1}]}',
    ],
)
def test_other_files_are_not_results(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(ValueError, match="/other.json is not a saved result"):
        ballpiston.load(next(os.scandir(tmp_path)))


def test_links_permissions_and_pipes_stay(tmp_path: Path) -> None:
    target, link, pipe = (tmp_path / name for name in ("target", "link", "pipe"))
    target.touch()
    target.chmod(0o640)
    link.symlink_to("target")
    write_atomically(link, b"text")
    assert link.is_symlink() and target.read_bytes() == b"text"
    assert target.stat().st_mode & 0o777 == 0o640

    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_atomically(pipe, b"text")
    assert os.read(reader, 9) == b"text" and sorted(tmp_path.iterdir()) == [link, pipe, target]
    os.close(reader)
    with pytest.raises(FileNotFoundError, match="'missing/x.json'$"):
        write_atomically(Path("missing/x.json"), b"text")


def test_a_result_of_an_unfinished_job_has_its_finished_points(
    client: ballpiston.Client, endless: ballpiston.Job, tmp_path: Path
) -> None:
    result = endless.result()
    assert len(result) == 0 and result.state in ("queued", "running")
    result.save(tmp_path / "saved.json")
    assert ballpiston.load(tmp_path / "saved.json") == result
    assert result.to_frame().empty
    assert "first-hit, 0 of 1 points" in repr(result)
