"""The table of the paper's equations in core/closed_form/README.md, which names the file and the
function that computes each, is complete, and its files and names exist."""

from __future__ import annotations

import re
from typing import NamedTuple

from sources import PROJECT, text_of

FOLDER = "core/closed_form/"  # of files that are named without a folder


class Row(NamedTuple):
    label: str
    where: str  # the last column


def rows_of(page: str) -> list[Row]:
    """The rows between the marks, without the header."""
    table = re.search(r"<!-- equations:begin -->(.*)<!-- equations:end -->", page, re.DOTALL)
    row = r"^\| `(\w+)` \| [^|\n]+ \| ([^|\n]+) \|$"
    return [Row(*found) for found in re.findall(row, table[1] if table else "", re.MULTILINE)]


def references(where: str) -> list[tuple[str, str]]:
    """The file and the name of each text `file: name`."""
    found = re.findall(r"`([\w/.]+): (\w+)`", where)
    return [(file if "/" in file else FOLDER + file, name) for file, name in found]


def wrong_rows(rows: list[Row]) -> list[str]:
    """One sentence for each row that names no function and does not say that it has none, and for
    each name that is not a word of its file."""
    wrong = []
    for label, where in rows:
        if not references(where) and not where.startswith("No function:"):
            wrong.append(f"{label}: names no function")
        for file, name in references(where):
            text = text_of(file) if (PROJECT / file).is_file() else ""
            if not re.search(rf"\b{name}\b", text):
                wrong.append(f"{label}: there is no {name} in {file}")
    return wrong


ROWS = rows_of(text_of(FOLDER + "README.md"))


def test_every_label_of_the_paper_is_in_its_order() -> None:
    labels = text_of("tests/data/equation_labels.txt").split()
    assert len(labels) == 49
    assert [row.label for row in ROWS] == labels


def test_every_name_is_in_its_file() -> None:
    wrong = wrong_rows(ROWS)
    assert not wrong, "\n".join(wrong)


# A test of the tests.
def test_missing_files_and_names_are_errors() -> None:
    right = [Row("K", "`kernel.h: PairKernel`"), Row("n", "No function: a constant")]
    assert wrong_rows(right) == []
    wrong = [Row("K", "`kernel.h: Kern`"), Row("dGc", "of `x`, `core/none.h: A2` and more")]
    assert wrong_rows([*wrong, Row("n", "a constant")]) == [
        "K: there is no Kern in core/closed_form/kernel.h",
        "dGc: there is no A2 in core/none.h",
        "n: names no function",
    ]
