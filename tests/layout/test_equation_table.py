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


# Tests of the tests.
def test_rows_are_read_between_the_marks() -> None:
    row = "| `Gv` | volume | `a.h: A` |\n"
    header = "| label | what it is | where |\n|---|---|---|\n"
    marked = f"{row}<!-- equations:begin -->\n{header}{row}<!-- equations:end -->\n{row}"
    assert rows_of(marked) == [Row("Gv", "`a.h: A`")]
    assert rows_of(row) == []


def test_references_are_files_with_names() -> None:
    found = references("`a.h: A`, of `x`; `core/b/c.h: D2` and more")
    assert found == [("core/closed_form/a.h", "A"), ("core/b/c.h", "D2")]


def test_missing_files_and_names_are_errors() -> None:
    right = [Row("K", "`kernel.h: PairKernel`"), Row("n", "No function: a constant")]
    assert wrong_rows(right) == []
    wrong = [Row("K", "`kernel.h: Kern`"), Row("dGc", "`none.h: A`"), Row("n", "a constant")]
    assert wrong_rows(wrong) == [
        "K: there is no Kern in core/closed_form/kernel.h",
        "dGc: there is no A in core/closed_form/none.h",
        "n: names no function",
    ]
