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
from conftest import FIRST_HITS, LIMIT, Home
from google.protobuf import json_format

import ballpiston
from ballpiston.command import exit_code_of
from ballpiston.whole_file import write_atomically


def test_a_result_is_equal_after_it_was_saved_and_loaded(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
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


def test_the_command_line_saves_the_same_arrays(home: Home, tmp_path: Path) -> None:
    question = "first-hit --rho 0.5296 --delta 0.2 --epsilon 0.1,0.4 --exponent 1 --samples 500"
    for name in ("saved.npz", "saved.json"):
        home.command("run", *question.split(), "--resume", "--save", str(tmp_path / name))
    arrays = ballpiston.load(tmp_path / "saved.json").arrays()
    with np.load(tmp_path / "saved.npz") as saved:
        assert sorted(saved) == sorted(arrays)
        for name in arrays:
            np.testing.assert_array_equal(saved[name], arrays[name], name)


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
    words = ("result", first_hits.job_name, "--save", str(saved))
    command = [home.programs / "ballpiston", *words]
    # Returns when no process has the standard output any more.
    client = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=LIMIT, check=False)
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


def test_sigterm_interrupts_a_program_without_a_traceback(home: Home) -> None:
    program = (
        "import signal, sys\n"
        "from ballpiston.command import run_program\n"
        "sys.exit(run_program(lambda _: signal.raise_signal(signal.SIGTERM) or [], []))"
    )
    interrupted = home.python(program)
    assert interrupted.communicate(timeout=LIMIT) == ("", "")
    assert interrupted.returncode == 130


def program_that_prints(name: str) -> str:
    return (
        "import sys\n"
        "from pathlib import Path\n"
        "from ballpiston.command import run_program\n"
        f"sys.exit(run_program(lambda _: [Path({ascii(name)})], []))"
    )


def test_a_program_prints_names_of_files_that_its_encoding_cannot_spell(home: Home) -> None:
    ascii_output = os.environ | {"PYTHONIOENCODING": "ascii"}
    printer = home.python(program_that_prints("\xfc"), env=ascii_output)
    assert printer.communicate(timeout=LIMIT) == ("ü\n", "")


@pytest.mark.parametrize(
    "out,code,why",
    [(">/dev/full", 2, "No space left"), (">&-", 2, "Bad file descriptor"), ("| true", 0, "")],
)
def test_a_full_disk_or_closed_output_is_an_error_and_a_closed_pipe_is_none(
    out: str, code: int, why: str
) -> None:
    shell = f'"$0" -c "$1" {out}; exit ${{PIPESTATUS[0]}}'
    command = ["bash", "-c", shell, sys.executable, program_that_prints("name")]
    buffered = os.environ | {"PYTHONUNBUFFERED": ""}
    printer = subprocess.run(command, capture_output=True, text=True, env=buffered, timeout=LIMIT)
    assert (printer.returncode, bool(printer.stderr)) == (code, bool(why))
    assert why in printer.stderr


def test_an_archive_has_the_arrays_of_the_result(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    first_hits.save(tmp_path / "saved.npz")
    arrays = first_hits.arrays()
    with np.load(tmp_path / "saved.npz") as archive:
        assert set(archive) == set(arrays)
        for name, array in arrays.items():
            np.testing.assert_array_equal(archive[name], array)
        provenance = json.loads(str(archive["provenance"]))
    assert provenance["job"] == first_hits.job_name
    assert provenance["client_version"] == ballpiston.__version__
    assert provenance["spec"]["seed"] == "7"


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
    assert arrays["provenance"].shape == ()


def test_loading_an_archive_says_that_numpy_reads_it(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    first_hits.save(tmp_path / "saved.npz")
    with pytest.raises(ValueError, match="numpy.load reads it"):
        ballpiston.load(tmp_path / "saved.npz")


def test_loading_needs_no_server(
    first_hits: ballpiston.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first_hits.save(tmp_path / "saved.json")
    monkeypatch.setenv("BALLPISTON_PROGRAM", "/does/not/exist")
    assert len(ballpiston.load(tmp_path / "saved.json")) == 4


def test_a_later_version_may_add_fields(first_hits: ballpiston.Result, tmp_path: Path) -> None:
    first_hits.save(tmp_path / "saved.json")
    document = json.loads((tmp_path / "saved.json").read_text())
    document["points"][0]["of_a_later_version"] = 1
    (tmp_path / "later.json").write_text(json.dumps(document))
    assert ballpiston.load(tmp_path / "later.json") == first_hits


def test_a_document_of_another_program_can_be_loaded(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    """With names in lowerCamelCase, 64-bit integers as strings, and a value without a number."""
    first_hits.save(tmp_path / "saved.json")
    document = json.loads((tmp_path / "saved.json").read_text())
    document["job"] = json_format.MessageToDict(first_hits.job)
    document["points"] = [json_format.MessageToDict(message) for message in first_hits.messages]
    estimate = document["points"][0]["estimates"][0]
    assert isinstance(document["job"]["spec"]["target"]["samples"], str)
    assert "standardError" in estimate
    value, estimate["value"] = estimate["value"], "NaN"
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
        '{"job": {}, "points": [1]}',
        '{"job": {"spec": {"seed": 1.5}}, "points": []}',
        '{"job": {}, "points": [{"samples": "many"}]}',
        '{"job": {}, "points": [{"estimates": 1}]}',
    ],
)
def test_other_files_are_not_results(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(ValueError, match="is not a saved result"):
        ballpiston.load(tmp_path / "other.json")


def test_the_end_of_the_name_decides_the_format(
    first_hits: ballpiston.Result, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=".json or .npz"):
        first_hits.save(tmp_path / "saved.csv")
    assert list(tmp_path.iterdir()) == []


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


def test_a_file_that_cannot_be_made_is_named_as_the_caller_names_it() -> None:
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


def test_a_result_holds_what_the_server_has(
    client: ballpiston.Client, first_hits: ballpiston.Result
) -> None:
    assert client.job(first_hits.job_name).result() == first_hits
    assert client.submit(**FIRST_HITS).specification == first_hits.specification
