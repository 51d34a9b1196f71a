"""Failures of all engines and of naive methods in the situations where methods fail

Failures per 100 starts of every method (columns) in every situation (rows). Failures are escapes,
negative times, loops, hits after which the ball still flies into the wall, missed and phantom hits
of the piston, and pistons beyond their walls. One start can fail several times. A cell is empty if
the method was not run in the situation.

It needs no server: the program `stability` counts the failures. With --full it takes about fourteen
minutes on one core, else some seconds, with a small part of the starts.
"""

import os
import re
from typing import Any

from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.patches import Rectangle

from ballpiston.figures.parts import style
from ballpiston.figures.parts.programs import output_of
from ballpiston.figures.parts.tables import Table, Tables, distinct, groups, table
from ballpiston.progress import has_terminal

EFFORT = {"quick": {}, "full": {"all_starts": True}}

_KINDS = {
    "escapes",
    "negative times",
    "loops",
    "still inward",
    "missed",
    "phantoms",
    "pistons beyond",
}
_NAIVE = 5  # the last columns are naive methods
_METHODS = (
    "lanes",
    "lanes, single",
    "reference",
    "reference, single",
    "reference, 64 bits",
    "reference, 113 bits",
    "jump process",
    "nearest root",
    "nearest root, no threshold",
    "approaching disc",
    "unit speed assumed",
    "fixed steps of 1e-3",
)
_SHADES = LinearSegmentedColormap.from_list("", ["#fdf0d5", "#fdbf6f", "#e8603c", "#8c1d18"])
_NO_FAILURE = "#d6e6f2"
_LINE = 25  # height of a line, in pixels


def measure(*, all_starts: bool = False) -> Tables:
    """The counts of all situations and methods, and in `failures` the sum of all kinds."""
    arguments = [] if all_starts else ["--quick"]
    quiet = os.environ.get("BALLPISTON_PROGRESS") in ("none", "json") or not has_terminal()
    return {"stability": counts(output_of("stability", *arguments, quiet=quiet))}


def counts(report: str) -> Table:
    """From the tables "All counts" of the program's report, which is Markdown. Only the first row
    of a block of rows contains the case."""
    found: list[dict[str, Any]] = []
    case = ""
    number = 0
    for section, text in re.findall(r"All counts: ([^<]*)<(.*?)</details>", report, re.DOTALL):
        lines = [line.strip("|").split("|") for line in text.splitlines() if line.startswith("|")]
        titles, _, *block = ([cell.strip() for cell in line] for line in lines)
        for line in block:
            cells = dict(zip(titles, line))
            if cells["case"]:
                case = cells["case"]
                number += 1
            row = {"section": section, "row": number, "case": case, "method": cells["method"]}
            counted = {name: cells[name].replace(",", "") for name in cells if cells[name] != "-"}
            row |= {"starts": int(counted["starts"])}
            found.append(row | {"failures": sum(int(counted[k]) for k in _KINDS & counted.keys())})
    return table(found)


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["stability"]
    lines = len(distinct(data["section"])) + len(distinct(data["row"]))
    figure = style.picture(980, 200 + _LINE * lines)
    axes = figure.add_subplot()
    axes.set(xlim=(-0.5, len(_METHODS) - 0.5), ylim=(lines - 0.5, -0.5))
    axes.grid(False)
    line, ticks = 0, {}
    for (section,), block in groups(data, "section"):
        axes.text(-0.6, line, section, ha="right", va="center", fontsize=11, fontweight="bold")
        line += 1
        for _, part in groups(block, "row"):
            ticks[line] = part["case"][0]
            _draw_cells(axes, part, line)
            line += 1
    axes.set_yticks(list(ticks), list(ticks.values()), fontsize=10)
    axes.set_xticks(range(len(_METHODS)), _METHODS, fontsize=10, rotation=55, ha="left")
    axes.xaxis.tick_top()
    axes.minorticks_off()
    axes.tick_params(length=0)
    axes.set_frame_on(False)
    axes.axvline(len(_METHODS) - _NAIVE - 0.5, color=style.BLACK, linewidth=1.5)
    figure.text(0.01, 0.99, "failures per 100 starts", va="top", fontsize=13)
    return figure


def _draw_cells(axes: Any, part: Table, line: int) -> None:
    shade = LogNorm(1e-4, 100, clip=True)
    for method, starts, failures in zip(part["method"], part["starts"], part["failures"]):
        x = _METHODS.index(method)
        rate = 100 * failures / starts
        colour = _SHADES(shade(rate)) if failures else _NO_FAILURE
        axes.add_patch(Rectangle((x - 0.46, line - 0.42), 0.92, 0.84, facecolor=colour))
        ink = "white" if rate > 2 else style.BLACK
        axes.text(x, line, rate_text(rate), ha="center", va="center", fontsize=9, color=ink)


def rate_text(rate: float) -> str:
    """Such as 0, 4e-4, 0.12, 35 or 3e4."""
    if 0 < rate < 0.01 or rate >= 9999.5:
        return f"{rate:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{rate:.2g}" if rate < 10 else f"{rate:.0f}"
