#!/usr/bin/env python3
"""Measures what the tests protect: makes small wrong changes, one at a time, and runs the tests.

    tests/mutation/mutation.py [--count N] [--seed N] [--commit REVISION]
    tests/mutation/mutation.py --replay FILE    exits with 1 if a mutant is not caught any more
    tests/mutation/mutation.py --table          the results so far

README.md describes the output.
"""

from __future__ import annotations

import argparse
import fcntl
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import table
from mutants import Mutant, draw, mutated
from running_tests import first_failure
from tree import TESTS, Tree

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build/mutation"
SHORTEST_HANG = 600.0  # seconds


def main() -> int:
    options = _options()
    FOLDER.mkdir(parents=True, exist_ok=True)
    path, run = _run_of(options)
    if options.table:
        return _print_tables(table.read(path), options.replay)
    lock = (FOLDER / "lock").open("w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SystemExit(f"another run uses {FOLDER}") from None
    results = table.Results(path, run)
    tree = Tree(ROOT, FOLDER, run["commit"], options.jobs)
    if options.replay:
        old = [table.mutant_of(r) for r in table.tried(table.read(options.replay))]
        _try_all(tree, results, old, len(old))
    else:
        _try_all(tree, results, draw(tree.path, list(TESTS), options.seed), options.count)
    return _print_tables(results.records, options.replay)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measures what the tests protect.")
    parser.add_argument("--count", type=int, default=60, help="mutants that compile (60)")
    parser.add_argument("--seed", type=int, default=1, help="of the drawing (1)")
    parser.add_argument("--commit", default="HEAD", help="whose sources and tests are used (HEAD)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel processes")
    parser.add_argument("--replay", type=Path, metavar="FILE", help="try its mutants again")
    parser.add_argument("--table", action="store_true", help="only print the results so far")
    return parser.parse_args()


def _run_of(options: argparse.Namespace) -> tuple[Path, table.Record]:
    """The file of the results, and its first line."""
    command = ["git", "-C", str(ROOT), "rev-parse", "--verify", f"{options.commit}^{{commit}}"]
    commit = subprocess.check_output(command, text=True).strip()
    if options.replay:
        name = f"replay-{commit[:12]}-of-{options.replay.stem}.jsonl"
        return FOLDER / name, {"commit": commit, "replay": table.read(options.replay)[0]}
    name = f"results-{commit[:12]}-{options.seed}.jsonl"
    return FOLDER / name, {"commit": commit, "seed": options.seed}


def _try_all(tree: Tree, results: table.Results, mutants: Iterable[Mutant], count: int) -> None:
    """Until so many compiled. Mutants of an earlier, interrupted run are not tried again."""
    seen: set[Mutant] = set()
    number = 0
    for mutant in mutants:
        if number == count:
            return
        if mutant in seen:
            continue
        seen.add(mutant)
        record = results.of(mutant) or results.add(_try(tree, results, mutant))
        number += record["result"] in (table.CAUGHT, table.MISSED)
        print(f"{table.row(number, record)} {record['seconds']:.0f} s", flush=True)


def _try(tree: Tree, results: table.Results, mutant: Mutant) -> table.Record:
    folder = mutant.file.split("/")[0]
    limit = max(SHORTEST_HANG, 10 * _unmutated_seconds(tree, results, folder))
    begin = time.monotonic()
    file = tree.path / mutant.file
    original = file.read_text() if file.exists() else ""
    text = mutated(mutant, original)
    if text is None:
        return {**mutant._asdict(), "result": table.GONE, "seconds": 0.0}
    file.write_text(text)
    try:
        by = None
        result = table.INVALID
        if tree.builds(folder):
            by = _failure(tree, folder, limit)
            result = table.CAUGHT if by else table.MISSED
    finally:
        file.write_text(original)
    seconds = round(time.monotonic() - begin, 1)
    return {**mutant._asdict(), "result": result, "by": by, "seconds": seconds}


def _unmutated_seconds(tree: Tree, results: table.Results, folder: str) -> float:
    """Without a mutant all tests must pass; otherwise the run ends here."""
    if seconds := results.seconds(folder):
        return seconds
    print(f"the tests of {folder}, without a mutant", flush=True)
    if not tree.builds(folder):
        raise SystemExit(f"{folder} does not build: see {FOLDER}/build.log")
    begin = time.monotonic()
    if by := _failure(tree, folder, float("inf")):
        raise SystemExit(f"{by} fails without a mutant: see {FOLDER}/failure.log")
    return results.add({"unmutated": folder, "seconds": time.monotonic() - begin})["seconds"]


def _failure(tree: Tree, folder: str, seconds: float) -> str | None:
    programs = [tree.build / "bin" / name for name in TESTS[folder]]
    return first_failure(programs, tree.jobs, seconds, FOLDER / "failure.log")


def _print_tables(records: list[table.Record], replay: Path | None) -> int:
    print(table.table(records))
    if not replay:
        return 0
    text, lost = table.comparison(table.read(replay), records)
    print(f"\n{text}")
    return int(lost > 0)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends the test programs too
    sys.exit(main())
