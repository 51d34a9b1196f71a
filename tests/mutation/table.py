"""The file of results, one JSON object a line, and the table made of it."""

from __future__ import annotations

import json
import os
from collections import Counter
from pathlib import Path
from typing import Any

from mutants import Mutant

Record = dict[str, Any]
CAUGHT, MISSED, GONE, INVALID = "caught", "missed", "gone", "does not compile"


class Results:
    """The first line names the run: its commit and its seed."""

    def __init__(self, path: Path, run: Record) -> None:
        self.path = path
        if path.exists():
            os.truncate(path, len(_whole_lines(path).encode()))
        self.records = read(path) if path.exists() else []
        if not self.records:
            self.add(run)
        elif self.records[0] != run:
            raise SystemExit(f"{path} belongs to another run: {self.records[0]}")

    def add(self, record: Record) -> Record:
        with self.path.open("a") as file:
            file.write(json.dumps(record) + "\n")
            file.flush()
            os.fsync(file.fileno())
        self.records.append(record)
        return record

    def seconds(self, folder: str) -> float | None:
        """How long the tests of the folder run without a mutant."""
        found = (r["seconds"] for r in self.records if r.get("unmutated") == folder)
        return next(found, None)

    def of(self, mutant: Mutant) -> Record | None:
        return next((r for r in self.records if "result" in r and mutant_of(r) == mutant), None)


def read(path: Path) -> list[Record]:
    if not path.exists():
        raise SystemExit(f"no results: {path}")
    return [json.loads(line) for line in _whole_lines(path).splitlines()]


def _whole_lines(path: Path) -> str:
    text = path.read_text()
    return text[: text.rfind("\n") + 1]  # a killed run leaves a part of a line


def mutant_of(record: Record) -> Mutant:
    return Mutant(*(record[field] for field in Mutant._fields))


def tried(records: list[Record]) -> list[Record]:
    """The records of mutants that compiled."""
    return [r for r in records if r.get("result") in (CAUGHT, MISSED)]


def row(number: int, record: Record) -> str:
    place = f"{record['file']}:{record['line']}"
    verdict = record["by"] if record["result"] == CAUGHT else f"**{record['result']}**"
    return f"| {number} | {place} | {record['operator']} | {_change(record)} | {verdict} |"


def table(records: list[Record]) -> str:
    """In Markdown: each mutant, then the counts of each folder."""
    lines = ["| | place | operator | change | caught by |", "|---|---|---|---|---|"]
    mutants = [r for r in records if r.get("result") in (CAUGHT, MISSED, GONE)]
    lines += [row(number, record) for number, record in enumerate(mutants, start=1)]
    lines += ["", "| folder | caught | missed | share caught |", "|---|---|---|---|"]
    counts = Counter((r["file"].split("/")[0], r["result"]) for r in tried(records))
    for folder in [*sorted({folder for folder, _ in counts}), "all"]:
        caught, missed = (
            sum(n for key, n in counts.items() if key[1] == result and folder in (key[0], "all"))
            for result in (CAUGHT, MISSED)
        )
        lines.append(f"| {folder} | {caught} | {missed} | {caught / max(caught + missed, 1):.0%} |")
    return "\n".join(lines)


def comparison(earlier: list[Record], now: list[Record]) -> tuple[str, int]:
    """The mutants whose result changed, and how many of them are not caught any more."""
    was = {mutant_of(record): record for record in tried(earlier)}
    changed = [r for r in tried(now) if r["result"] != was[mutant_of(r)]["result"]]
    lines = [f"{len(tried(earlier))} mutants, {len(tried(now))} tried again"]
    lost = [r for r in changed if r["result"] == MISSED]
    for title, records in (("lost", lost), ("gained", [r for r in changed if r not in lost])):
        lines.append(f"{title}: {len(records)}")
        lines += [row(n, {**was[mutant_of(r)], **r}) for n, r in enumerate(records, start=1)]
    return "\n".join(lines), len(lost)


def _change(record: Record) -> str:
    """A short change is shown with its neighbours in the line."""
    text, start, before = record["text"], record["column"], record["before"]
    left, right = "", ""
    if len(before) < 12:
        left, right = text[max(0, start - 12) : start], text[start + len(before) :][:12]
    return f"{_code(left + before + right)} -> {_code(left + record['after'] + right)}"


def _code(text: str, length: int = 40) -> str:
    text = " ".join(text.split()).replace("|", "\\|")
    return f"`{text if len(text) <= length else text[: length - 3] + '...'}`"
