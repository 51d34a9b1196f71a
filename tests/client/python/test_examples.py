"""The examples run as they are."""

from __future__ import annotations

import contextlib
import io
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import PROJECT

import ballpiston

EXAMPLES = PROJECT / "client" / "examples" / "python"


def test_the_sweep_prints_a_table_and_saves_its_result(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "sweep.py")],
        cwd=tmp_path,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    first = [line.split()[0] for line in done.stdout.splitlines()[1:]]
    assert first == ["delta", "0.200", "0.100", "0.050"]
    result = ballpiston.load(tmp_path / "sweep.json")
    # The false-alarm rate of 5 sigma is 6e-7; the seed is fixed.
    assert max(abs(result.z_score("mean_free_time_ball_piston"))) < 5


NOTEBOOKS = sorted(path.name for path in EXAMPLES.glob("*.ipynb"))
assert NOTEBOOKS


def text_of(cell: dict[str, Any]) -> str:
    """What the cell printed when its output was stored."""
    outputs = [output for output in cell["outputs"] if output["output_type"] == "stream"]
    return "".join(line for output in outputs for line in output["text"])


def without_names(text: str) -> str:
    """Without the names of jobs, which are random, and the version of the engine."""
    return re.sub(r"ensembleJobs/\w+|engine [\d.]+", "", text)


# Their own checks compare measured numbers with exact ones; the bound is 5 standard errors, and the
# seeds are fixed. The stored output is written again by `make tutorials`.
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_runs_and_prints_its_stored_output(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    cells = json.loads((EXAMPLES / name).read_text(encoding="utf-8"))["cells"]
    cells = [cell for cell in cells if cell["cell_type"] == "code"]
    assert any("\nassert " in "".join(cell["source"]) for cell in cells)
    names: dict[str, object] = {}
    for cell in [*cells, *cells]:  # the second time in the folder of the first
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec("".join(cell["source"]), names)
        assert without_names(printed.getvalue()) == without_names(text_of(cell))


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_valid_and_says_what_one_learns(name: str) -> None:
    first = json.loads((EXAMPLES / name).read_text(encoding="utf-8"))["cells"][0]
    assert first["cell_type"] == "markdown" and "**You learn** " in "".join(first["source"])
    nbformat = pytest.importorskip("nbformat")
    nbformat.validate(nbformat.read(EXAMPLES / name, as_version=4))
