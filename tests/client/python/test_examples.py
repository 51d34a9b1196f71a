"""The examples run as they are."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

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
    assert [line.split()[0] for line in done.stdout.splitlines()[1:]] == [
        "delta",
        "0.200",
        "0.100",
        "0.050",
    ]
    result = ballpiston.load(tmp_path / "sweep.json")
    # The false-alarm rate of 5 sigma is 6e-7; the seed is fixed.
    assert max(abs(result.z_score("mean_free_time_ball_piston"))) < 5


def run_notebook(name: str) -> dict[str, object]:
    """The names that its cells define."""
    notebook = json.loads((EXAMPLES / name).read_text())
    names: dict[str, object] = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
            exec("".join(cell["source"]), names)
    return names


def test_every_cell_of_the_figure_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    names = run_notebook("figure.ipynb")
    assert "</svg>" in (tmp_path / "mean-free-times.svg").read_text()
    result = ballpiston.load(tmp_path / "mean-free-times.json")
    assert result == names["result"]
    # 36 z-scores; the false-alarm rate of 5 sigma is 2e-5, and the seed is fixed.
    assert max(abs(result.z_score("mean_free_time_conditional"))) < 5


def test_an_observable_of_ones_own_has_the_exact_mean() -> None:
    names = run_notebook("own_observable.ipynb")
    # Waits of an orbit are correlated, which the simple error leaves out; the seed is fixed.
    assert abs(names["z_score"]) < 5  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["figure.ipynb", "own_observable.ipynb"])
def test_a_notebook_is_valid(name: str) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbformat.validate(nbformat.read(EXAMPLES / name, as_version=4))
