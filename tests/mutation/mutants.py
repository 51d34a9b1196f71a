"""Mutants: one small wrong change of one line, drawn from the sources."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from cpp_text import CppText
from operators import OPERATORS, Change


class Mutant(NamedTuple):
    file: str
    line: int
    text: str  # of the line, without indentation
    column: int  # of the change, in `text`
    operator: str
    before: str
    after: str


def draw(root: Path, folders: list[str], seed: int) -> Iterator[Mutant]:
    """Draws a folder by its lines, a line that can be changed, an operator, and a change."""
    chance = random.Random(seed)
    lines = [_lines(root, folder) for folder in folders]
    mutants = cache(lambda file: _mutants(file, (root / file).read_text()))
    while True:
        (of_folder,) = chance.choices(lines, weights=[len(of_folder) for of_folder in lines])
        by_operator: dict[str, list[Mutant]] = {}
        while not by_operator:
            file, number = chance.choice(of_folder)
            by_operator = mutants(file).get(number, {})
        yield chance.choice(chance.choice(list(by_operator.values())))


def mutated(mutant: Mutant, text: str) -> str | None:
    """The text with the change, at the nearest line that reads the same; None if there is none."""
    starts = [0] + [i + 1 for i, c in enumerate(text) if c == "\n"]
    places = []
    for number, (start, line) in enumerate(zip(starts, text.split("\n")), start=1):
        place = start + len(line) - len(line.lstrip()) + mutant.column
        if line.strip() == mutant.text and text.startswith(mutant.before, place):
            places.append((abs(number - mutant.line), place))
    if not places:
        return None
    place = min(places)[1]
    return text[:place] + mutant.after + text[place + len(mutant.before) :]


def _lines(root: Path, folder: str) -> list[tuple[str, int]]:
    """Each line of C++ as its file and number. Examples are not compiled by the tests."""
    return [
        (str(file.relative_to(root)), number)
        for file in sorted((root / folder).rglob("*.*"))
        if file.suffix in (".cc", ".h") and "examples" not in file.parts
        for number in range(1, file.read_text().count("\n") + 1)
    ]


def _mutants(file: str, text: str) -> dict[int, dict[str, list[Mutant]]]:
    """By line and operator."""
    cpp = CppText(text)
    found: dict[int, dict[str, list[Mutant]]] = defaultdict(lambda: defaultdict(list))
    for operator in OPERATORS:
        name = operator.__name__.replace("_", " ")
        for change in operator(cpp):
            mutant = _mutant(file, cpp, name, change)
            found[mutant.line][name].append(mutant)
    return found


def _mutant(file: str, cpp: CppText, operator: str, change: Change) -> Mutant:
    start = cpp.tokens[change.first].start
    line = cpp.text.count("\n", 0, start)
    text = cpp.text.split("\n")[line]
    column = start - cpp.text.rfind("\n", 0, start) - 1 - (len(text) - len(text.lstrip()))
    before = cpp.between(change.first, change.last)
    return Mutant(file, line + 1, text.strip(), column, operator, before, change.after)
