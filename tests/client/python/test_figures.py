"""The figures measure what their predecessors measured, and their pictures hold their texts.

figures_reference.json says how its tables were made.
"""

from __future__ import annotations

import importlib
import json
import os
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.text import Text

import ballpiston
from ballpiston import figures
from ballpiston.figures import __main__ as command
from ballpiston.figures import gas, hitting_time, ingoing_law, kernel, markov_test
from ballpiston.figures import rates, section, speed_accuracy, stability
from ballpiston.figures.parts import oscillation, programs, style, tables
from ballpiston.table import write_table

REFERENCE = json.loads(
    Path(__file__).with_name("figures_reference.json").read_text(encoding="utf-8")
)
ROUNDING = 2e-5  # the scripts printed six digits


def module(name: str) -> Any:
    return importlib.import_module(f"ballpiston.figures.{name.replace('-', '_')}")


def expect_equal(table: tables.Table, reference: dict[str, Any], name: str) -> None:
    """Numbers within rounding; None in the reference is NaN."""
    for column, expected in reference["values"].items():
        every, where = table[column], f"{name}: {column}"
        assert len(every) == reference["rows"], where
        found = every[:: reference["every"]]
        if found.dtype.kind in "US":
            assert found.tolist() == expected, where
            continue
        numbers = np.array(expected, dtype=float)
        options: Any = {"rtol": ROUNDING, "atol": 1e-12, "err_msg": where}
        np.testing.assert_allclose(found.astype(float), numbers, **options)
        if column in reference["sums"]:
            tolerance = ROUNDING * np.nansum(np.abs(every))
            assert abs(np.nansum(every) - reference["sums"][column]) <= tolerance, where


@pytest.mark.parametrize("name", REFERENCE["figures"])
def test_a_figure_measures_what_its_script_measured_and_its_texts_are_inside_the_picture(
    name: str, client: ballpiston.Client
) -> None:
    reference = REFERENCE["figures"][name]
    measured = module(name).measure(client, **reference["keywords"])
    for table, expected in reference["tables"].items():
        expect_equal(measured[table], expected, table)
    expect_texts_inside(module(name).draw(measured))


def expect_texts_inside(figure: Any) -> None:
    figure.draw_without_rendering()
    width, height = figure.bbox.size
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text() and text.axes is not None:
            box = text.get_window_extent()
            is_inside = box.x0 > -1 and box.y0 > -1 and box.x1 < width + 1 and box.y1 < height + 1
            is_far = box.x0 > width or box.x1 < 0 or box.y0 > height or box.y1 < 0  # a clipped tick
            assert is_inside or is_far, f"{text.get_text()!r} crosses the edge of the picture"


# The numbers that figures compute


# The random numbers of the fits differ from those of the script. A difference of two shares of 200
# data sets has a standard error of at most 0.05; five times this is exceeded in 6e-7 of all cases.
def test_relative_entropies_are_analysed_as_by_the_script() -> None:
    of = {name.removeprefix("markov-test-"): of for name, of in REFERENCE["analysis"].items()}
    excess = {name: np.array(values) for name, values in of["excess"]["values"].items()}
    expect_equal(markov_test.decay(excess), of["decay"], "decay")
    expect_equal(markov_test.maxima(excess), of["maxima"], "maxima")
    fits, expected = oscillation.fits(excess, 200), dict(of["fit"]["values"])
    for name in ("false_alarm", "p_value"):
        shares = np.array(expected.pop(name), dtype=float)
        np.testing.assert_allclose(fits[name], shares, rtol=0, atol=0.25, err_msg=name)
    expect_equal(fits, of["fit"] | {"values": expected}, "fit")


def test_the_error_of_an_excess_is_at_least_that_of_the_noise_floor() -> None:
    divergence = {name: np.full(2, 0.5) for name in ("delta", "epsilon", "exponent")}
    divergence |= {"value": np.array([3.0, 3.0]), "noise_floor": np.array([1.0, 2.0])}
    divergence |= {"standard_error": np.array([0.1, 0.4]), "noise_error": np.array([0.3, 0.2])}
    points = markov_test.excess(divergence)
    assert points["excess"].tolist() == [2.0, 1.0]
    assert points["standard_error"].tolist() == [0.3, 0.4]


@pytest.mark.parametrize(
    "dip,error,count", [(0.7, 0.01, 2), (0.9, 0.01, 1), (0.7, 0.2, 1)], ids=["deep", "flat", "weak"]
)
def test_a_dip_parts_two_maxima_if_it_is_deep_and_certain(
    dip: float, error: float, count: int
) -> None:
    excess = np.array([0.1, 1.0, dip, 1.1, 0.1])
    points = {name: np.full(5, 0.5) for name in ("epsilon", "exponent")}
    points |= {"delta": np.geomspace(0.1, 0.3, 5), "excess": excess}
    points["standard_error"] = np.full(5, error)
    assert len(markov_test.maxima(points)["delta"]) == count
    points["exponent"] = np.ones(5)  # the equilibrium law is left out, the columns stay
    assert [len(column) for column in markov_test.maxima(points).values()] == [0] * 5


def test_the_maximum_of_three_equal_points_is_the_middle_one() -> None:
    points = {name: np.full(5, 0.5) for name in ("epsilon", "exponent")}
    points |= {"delta": np.geomspace(0.1, 0.3, 5), "excess": np.array([0.1, 5, 5, 5, 0.1])}
    points["standard_error"] = np.array([0.01, 0.01, 0.01, 5, 0.01])
    assert markov_test.maxima(points)["delta"] == pytest.approx(points["delta"][2:3], rel=1e-14)


def test_an_oscillation_in_log_delta_is_found_with_its_period_and_amplitude() -> None:
    delta = np.geomspace(0.02, 0.3, 60)
    error = 0.01
    wave = 0.3 * np.cos(2 * np.pi * np.log(delta) / 0.5)
    noise = error * np.random.default_rng(1).standard_normal(60)
    points = {
        "delta": delta,
        "epsilon": np.full(60, 0.4),
        "exponent": np.full(60, 5.0),
        "excess": delta**2 * np.exp(wave + noise),
    }
    points["standard_error"] = error * points["excess"]
    found = tables.rows(oscillation.fits(points, 20), model="log(delta)", exponent=5.0)
    assert found["b"][0] == pytest.approx(2, abs=0.02)
    assert found["amplitude"][0] == pytest.approx(0.3, abs=0.02)
    assert found["period"][0] == pytest.approx(0.5, abs=0.02)
    assert found["false_alarm"][0] == 0
    assert found["transform"][0] == 0


def test_merged_bins_keep_the_probability() -> None:
    count = np.arange(10.0)
    bins = {name: np.full(10, 0.5) for name in ("delta", "epsilon", "exponent", "sigma")}
    bins |= {"samples": np.full(10, 45.0), "lower": np.arange(10.0), "upper": np.arange(1.0, 11)}
    bins |= {"count": count, "density": count / 45, "exact_density": np.full(10, 0.1)}
    merged = ingoing_law.merge(bins, 4)
    assert merged["density"] * [4, 4, 2] == pytest.approx([6 / 45, 22 / 45, 17 / 45])
    assert merged["error"] == pytest.approx(np.sqrt([6, 22, 17]) / 45 / [4, 4, 2])
    assert merged["alpha"].tolist() == [2.0, 6.0, 9.0]
    empty = ingoing_law.merge(bins | {"count": 0 * count}, 4)["error"]
    assert empty == pytest.approx(np.sqrt(45 * 0.1 / np.array([4, 4, 2])) / 45)


def test_an_empty_bin_of_the_kernel_has_an_error() -> None:
    hit = {"piston_energy": np.array([0.1]), "piston_energy_after": np.array([0.01])}
    found = kernel.densities([0.1], hit, 2)
    assert found["count"].tolist() == [1, 0]
    assert found["standard_error"] == pytest.approx(found["density"][0] / np.array([1, 3]))


def test_few_gaps_have_no_error_and_no_gap_has_no_rate() -> None:
    ends = np.array([1.0, 2.0])
    for gaps, known in (([np.ones(49), ends[:0]], False), ([np.ones(25), 2 * np.ones(25)], True)):
        rate, error = rates.rate_of_windows(gaps, ends)
        assert rate[0] == pytest.approx(1 if not known else 2 / 3)
        assert np.isfinite(error).all() == known
    assert np.isnan(rates.rate_of_windows([ends[:0]] * 2, ends)).all()


def test_a_repeated_energy_has_one_line(client: ballpiston.Client) -> None:
    data = rates.measure(client, epsilon="0.25,0.3,0.25", orbits=1, events=800)["rates"]
    assert len(list(tables.groups(data, "kind", "lower"))) * 17 == len(data["t"]) == 4 * 17


def test_first_hits_at_the_ends_of_the_energy_are_drawn_with_errors(
    client: ballpiston.Client,
) -> None:
    data = hitting_time.measure(client, delta="0.2,0.3", epsilon="0,0.25,0.5", samples=200)
    inexact = tables.pick(data["hitting-time"], data["hitting-time"]["t"] > 0)
    assert (inexact["error"] > 0).all()
    between = tables.rows(data["hitting-time"], epsilon=0.25)
    assert between["limit"] == pytest.approx(np.exp(-between["t"]))
    expect_texts_inside(hitting_time.draw(data))


def test_a_chain_is_drawn_as_one_row(client: ballpiston.Client) -> None:
    data = gas.measure(client, cells="4")
    geometry = data["gas-geometry"]
    assert (geometry["columns"][0], geometry["rows"][0]) == (4, 1)
    assert len(data["gas-pistons"]["x"]) == 4
    expect_texts_inside(gas.draw(data))


# Chi-squared of collisions, and of the hits of an orbit, that are nearly independent; beyond 6
# standard deviations of a normal law in 1e-6. Few collisions are outside of all bins. Of an orbit's
# events 83 % are wall hits, give or take 1 %.
def test_collisions_and_wall_hits_have_the_invariant_density(client: ballpiston.Client) -> None:
    data = section.measure(client, delta=0.2, collisions=50_000, events=60_000, bins=10)
    for name in ("alpha", "y", "s"):
        part = tables.rows(data["section"], section=name)
        assert part["count"].sum() == pytest.approx(part["expected"].sum(), rel=1e-3)
        assert part["count"].sum() == (50_000 if name != "s" else pytest.approx(50_000, rel=0.04))
    for chi_squared, bins in zip(*(data["section-test"][n] for n in ("chi_squared", "bins"))):
        assert abs(chi_squared - bins) < 6 * np.sqrt(2 * bins)
    expect_texts_inside(section.draw(data))


# In a row every kind of failure has a different count, so that the sum shows which kinds it has.
REPORT = """| case | lanes |
|:-----|------:|
| not a count | 5 |
<details><summary>All counts: the ball alone</summary>

| case | method | starts | wall hits | escapes | negative times | loops | still inward | missed |
|:-----|:-------|-------:|----------:|--------:|---------------:|------:|-------------:|-------:|
| cusps | lanes | 4,000 | 120,000 | 0 | 0 | 0 | 0 | - |
| | lanes, single | 4 | 22 | 1 | 20 | 300 | 4,000 | - |
| any orbits | lanes | 22 | 440 | 0 | 0 | 0 | 0 | 5 |

</details>
<details><summary>All counts: the gas</summary>

| case | method | starts | escapes | looked back | missed | phantoms | pistons beyond | worst dE/E |
|:-----|:-------|-------:|--------:|------------:|-------:|---------:|---------------:|-----------:|
| any gas | jump process | 16 | 0 | 9 | 1 | 20 | 300 | 7.8e-16 |
</details>
"""


def test_the_counts_of_failures_are_read_from_the_report() -> None:
    assert {name: column.tolist() for name, column in stability.counts(REPORT).items()} == {
        "section": ["the ball alone"] * 3 + ["the gas"],
        "row": [1, 1, 2, 3],
        "case": ["cusps", "cusps", "any orbits", "any gas"],
        "method": ["lanes", "lanes, single", "lanes", "jump process"],
        "starts": [4000, 4, 22, 16],
        "failures": [0, 4321, 5, 321],
    }


def test_a_rate_of_failures_fits_into_its_cell() -> None:
    found = [stability.rate_text(rate) for rate in (0, 4e-4, 0.12, 35, 7966, 34271)]
    assert found == ["0", "4e-4", "0.12", "35", "7966", "3e4"]


MEASUREMENTS = """rho,delta,epsilon,method,time_step,quantity,samples,wall_hits,work_seconds,value,\
statistical_error,own_error,bias_resolved
0.53,0.1,0.125,fixed-step,0.1,mean-free-time,100,2000,0.001,0.4,0.06,0.08,1
0.53,0.1,0.125,fixed-step,0.1,mean-free-time,400,8000,0.004,0.4,0.03,0.3,1
0.53,0.1,0.125,billiard,0,mean-free-time,400,8000,0.0001,0.01,0.03,0.05,0
0.53,0.1,0.125,closed-form,0,mean-free-time,0,0,2e-7,6e-15,,,0
0.53,0.1,0.125,billiard,0,ingoing-law,400,8000,0.0001,0.01,0.03,0.05,0
0.53,0.1,0.125,billiard,0,trajectory,64,1000,0.00001,30,1,2,0
"""


def test_a_resolved_bias_is_part_of_the_expected_error() -> None:
    data = programs.read_table(MEASUREMENTS)
    step, lanes = (runs for runs, *_ in speed_accuracy.curves_of(data, "mean-free-time", 64))
    biases = [speed_accuracy.resolved_bias(runs) for runs in (step, lanes)]
    assert biases == [(0.4, 0.03), (0, 0.03)]
    error, error_of_error = speed_accuracy.expected_error(step, *biases[0])
    assert error == pytest.approx([np.hypot(0.08, 0.4), 0.5])
    of_chance, of_bias = 0.3**2 / np.sqrt(800), 0.4 * 0.03
    assert error_of_error[1] == pytest.approx(np.hypot(of_chance, of_bias) / 0.5)
    assert speed_accuracy.expected_error(lanes, *biases[1])[1] == pytest.approx(0.05 / np.sqrt(800))


RELAXATIONS = """0.53,0.1,0.125,spectrum,0,relaxation-time,0,0,0.1,0.4375,0.25,0.01,0
0.53,0.2,0.125,spectrum,0,relaxation-time,0,0,0.1,0.5,0.25,0.01,0
0.53,0.2,0.125,spectrum,0,relaxation-time,0,0,0.1,0.5,0.25,0.01,0
0.53,0.2,0.125,markov,0,relaxation-time,512,0,0.1,0.6,0.25,0.1,0
"""


def test_the_floor_of_the_limit_is_its_bias_from_two_errors_on_else_a_bound() -> None:
    data = programs.read_table(MEASUREMENTS + RELAXATIONS)
    runs = tables.rows(data, quantity="relaxation-time")
    floors = speed_accuracy.floors_of_limit(runs)
    assert floors["delta"].tolist() == [0.2, 0.1]
    assert floors["value"].tolist() == [0.5, 0.4375 + 2 * 0.25]
    assert floors["is_bias"].tolist() == [True, False]
    panel = speed_accuracy.draw({"speed-accuracy": data}).axes[4]
    (bar,) = panel.containers[0].lines[2][0].get_segments()  # of the limit, at delta = 0.2
    assert np.ptp(bar[:, 1]) == pytest.approx(2 * 0.5 * 0.25 / np.hypot(0.1, 0.5), rel=1e-3)


def test_measurements_without_a_gas_and_a_limit_are_drawn() -> None:
    data = programs.read_table(MEASUREMENTS)
    figure = speed_accuracy.draw({"speed-accuracy": data})
    expect_texts_inside(figure)
    assert len(figure.axes) == 4


# Files


def test_tables_are_written_with_all_digits(tmp_path: Path) -> None:
    table = {"x": np.array([0.1, np.nan]), "name": np.array(["a, b", "c"])}
    write_table(tmp_path / "table.csv", table, "made by a test")
    text = (tmp_path / "table.csv").read_text()
    assert text == '# made by a test\nx,name\n0.1,"a, b"\n,c\n'


@pytest.mark.filterwarnings("ignore:elementwise comparison:FutureWarning")  # of NumPy 1.24
def test_rows_are_chosen_from_empty_and_numeric_columns_too() -> None:
    whole = {"x": np.ones(2), "name": np.array(["a", "b"])}
    assert tables.rows(whole)["x"].tolist() == [1, 1]
    for part in (whole, tables.pick(whole, slice(0))):
        assert len(tables.rows(part, x="text", name="a")["x"]) == 0


def test_a_point_without_a_known_error_is_hollow() -> None:
    axes = style.picture(300, 200).subplots()
    style.error_points(axes, [1, 2, 3], [4, 5, 6], [0.1, np.nan, 0.2], style.BLUE)
    full, hollow = (line for line in axes.lines if line.get_marker() == "o")
    assert full.get_xdata().tolist() == [1, 2, 3]
    assert (hollow.get_xdata().tolist(), hollow.get_markerfacecolor()) == ([2], "white")
    assert hollow.get_zorder() >= full.get_zorder()  # later, so above it


def test_the_same_picture_gives_the_same_file(tmp_path: Path) -> None:
    data = {"cell-3d": {"rho": np.array([0.65]), "delta": np.array([0.08])}}
    data["cell-3d"] |= {"lambda": np.array([0.83]), "eta": np.array([0.1])}
    files = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for file, box in zip(files, ("standard", "tight")):
        with matplotlib.rc_context({"savefig.bbox": box}):  # of a matplotlibrc
            style.save(module("cell_3d").draw(data), file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert b"heights drawn" in files[0].read_bytes()


def test_a_picture_is_written_to_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(pipe := tmp_path / "a.png")
    end = os.open(pipe, os.O_RDWR)
    style.save(style.picture(30, 20), pipe)
    assert os.read(end, 4) == b"\x89PNG"
    os.close(end)


@pytest.mark.parametrize(
    "words,text",
    [
        (["mean-free-tim"], "'mean-free-tim' is not a figure (cell, cell-3d, "),
        (["cell", "--samples", "3"], "--samples: the figure cell has no such variable"),
        (["cell", "--sead", "3"], "did you mean '--seed'?"),
        (["cell", "--quick", "--full"], "--full: not allowed with argument --quick"),
        (["cell", "--seed", "1.5"], "--seed has to be a whole number"),
        (["cell", "--seed", "-1"], "--seed has to be from 0 to"),
        (["cell", "--delta", "0.1,0.2"], "--delta: '0.1,0.2' is not one number"),
        (["cell", "--delta", "0.9"], "delta is 0.9; permitted"),
        (["stability", "--all-starts", "no"], "--all-starts has to be true or false, not 'no'"),
        (["rates", "--orbits", "0"], "--orbits has to be from 1 to"),
        (["rates", "--events", "7"], "events is 7; permitted: 8 to 1000000"),
        (["conductivity", "--cells", "3x3"], "cells: 3x3 is a lattice; permitted: lengths of"),
        (["temperature-profile", "--cells", "4,2x2"], "cells: 2x2 is a lattice"),
        (["full-counting", "--cells", "4x2"], "cells: 4x2 is a lattice"),
        (["full-counting", "--hot", "1", "--cold", "1"], "hot and cold have to differ"),
        (["section", "--bins", "1"], "bins is 1; permitted: 2 to 300"),
        (["section", "--bins", "301"], "bins is 301; permitted: 2 to 300"),
        (["kernel", "--bins", "1e15"], "bins is 1000000000000000; permitted: 1 to 10000"),
    ],
)
def test_wrong_values_are_named_before_anything_is_measured(
    words: list[str], text: str, home: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command.main([*words, "--out", str(tmp_path)]) == 2
    assert text in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_every_figure_can_be_edited(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in figures.names():
        assert set(getattr(module(name), "EFFORT", {})) <= {"quick", "full"}
        assert not module(name).__doc__.splitlines()[0].endswith(".")
        assert command.main([name, "--edit", "--out", str(tmp_path)]) == 0
        assert f"{name.replace('-', '_')}.py" in capsys.readouterr().out
        with pytest.raises(SystemExit):  # the help of the edited module
            command.main([name, "--out", str(tmp_path), "--help"])


def test_an_edited_module_is_used_and_kept_and_its_data_stay_if_the_picture_fails(
    home: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command.main(["cell", "--edit", "--out", str(tmp_path)])
    own = tmp_path / "cell.py"
    edited = own.read_text() + "\n\ndef draw(_):\n    raise ValueError('no picture')\n"
    own.write_text(edited)
    assert command.main(["cell", "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert "cell.py, which differs" in error and "no picture" in error
    assert own.read_text() == edited
    assert list(tmp_path.glob("*.csv")) and not list(tmp_path.glob("*.svg"))


EDITED = """from __future__ import annotations
import dataclasses, pickle
from ballpiston.figures import cell
draw = cell.draw

@dataclasses.dataclass
class Own:
    number: int

def measure(client, *, _private: int = 1):
    assert pickle.loads(pickle.dumps(Own(_private))) == Own(1)
    return cell.measure(client)
"""


def test_an_edited_module_may_pickle_its_classes(home: Any, tmp_path: Path) -> None:
    (tmp_path / "cell.py").write_text(EDITED)
    assert command.main(["cell", "--out", str(tmp_path)]) == 0


def test_help_lists_the_variables_of_a_figure(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        command.main(["relaxation", "--delta", "0.1", "--help"])
    text = capsys.readouterr().out
    assert "Relaxation of the piston's energy" in text
    assert "--samples VALUE" in text and "by default 200000" in text


def test_a_folder_or_picture_that_cannot_be_made_is_an_error(
    home: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command.main(["cell"]) == 2
    assert "--out is missing: name a folder" in capsys.readouterr().err
    file = tmp_path / "file"
    file.touch()
    assert command.main(["cell", "--out", str(file)]) == 2
    assert f"--out: cannot write {file}: File exists" in capsys.readouterr().err
    (tmp_path / "cell.png").mkdir()
    assert command.main(["cell", "--out", str(tmp_path)]) == 2
    assert "cell.png" in capsys.readouterr().err


def test_a_program_that_is_missing_or_fails_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("BALLPISTON_PROGRAM", str(tmp_path / "ballpiston"))
    monkeypatch.setenv("PATH", "/no/such/folder")
    words = ["speed-accuracy", "--out", str(tmp_path)]
    assert command.main(words) == 4
    assert "method_comparison: not found beside" in capfd.readouterr().err
    program = tmp_path / "method_comparison"
    for status, code in ((1, 4), (2, 2)):
        program.write_text(f"#!/bin/sh\necho because {status} >&2; exit {status}\n")
        program.chmod(0o700)
        assert command.main(words) == code
        assert f"because {status}" in capfd.readouterr().err


# The client's functions that figures use


def test_trace_arrays_have_the_fields_of_the_events(client: ballpiston.Client) -> None:
    orbit = {"rho": 0.53, "delta": 0.3, "events": 300, "seed": 5}
    names = ("time", "event", "free_time", "piston_energy")
    arrays = client.trace_arrays(*names, **orbit)
    _, *events = client.trace(**orbit)
    for name in names:
        expected = [event.get(name, np.nan) for event in events]
        assert np.array_equal(arrays[name], expected, equal_nan=name != "event")
    with pytest.raises(ValueError, match="no field 'tme'; did you mean"):
        client.trace_arrays("tme", **orbit)


def test_progress_as_json_has_one_line_for_each_message(
    client: ballpiston.Client, capsys: pytest.CaptureFixture[str]
) -> None:
    job = client.submit("equilibrium", rho=0.53, delta=0.2, model="billiard", collisions=2000)
    job.watch("json")
    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert lines[-1]["job"] == job.name
    assert lines[-1]["state"] == "SUCCEEDED"
    assert lines[-1]["progress"]["points_done"] == 1
