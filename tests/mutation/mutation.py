#!/usr/bin/env python3
"""Measures what the tests protect: makes small wrong changes, one at a time, and runs the tests.

    tests/mutation/mutation.py [--count N] [--seed N] [--commit REVISION]
    tests/mutation/mutation.py --replay FILE    exits with 1 if a mutant is not caught any more

README.md describes the output.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import operators

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build/mutation"
TREE = FOLDER / "tree"  # a clone in which mutants are built
# The fast test programs of each folder, and the program that has its main function.
TESTS = {
    "core": ["core_test"],
    "server": ["server_test", "worker_test", "store_fault_test", "simulation_test"],
    "client": ["client_test", "interrupts_test"],
}
PROGRAMS = {"core": [], "server": ["ballpistond"], "client": ["ballpiston", "ballpiston-web"]}
LONGEST_USUAL = 1000.0  # seconds of all parts without a mutant; far more than they take
SHORTEST_HANG = 120.0  # seconds; a part that ends earlier does not hang
CAUGHT, MISSED, GONE, INVALID = "caught", "missed", "gone", "does not compile"
MUTANT = ("file", "line", "text", "column", "operator", "before", "after")

Record = dict[str, Any]  # a mutant, and what became of it


# ---- mutants ----


def mutants(file: str, text: str) -> dict[int, dict[str, list[Record]]]:
    """By line and operator. `text` is the first changed line, without its indentation."""
    found: dict[int, dict[str, list[Record]]] = {}
    for operator, start, end, after in operators.changes(text):
        number, begin = text.count("\n", 0, start) + 1, text.rfind("\n", 0, start) + 1
        line = text[begin:].split("\n", 1)[0]
        column = start - begin - (len(line) - len(line.lstrip()))
        values = (file, number, line.strip(), column, operator, text[start:end], after)
        found.setdefault(number, {}).setdefault(operator, []).append(dict(zip(MUTANT, values)))
    return found


def draw(root: Path, seed: int) -> Iterator[Record]:
    """Draws a line of C++ that can be changed, an operator, and a change. Examples are left out,
    because the tests do not compile them."""
    lines = [
        (str(file.relative_to(root)), number)
        for folder in TESTS
        for file in sorted((root / folder).rglob("*.*"))
        if file.suffix in (".cc", ".h") and "examples" not in file.parts
        for number in range(1, file.read_text().count("\n") + 1)
    ]
    of_file = cache(lambda file: mutants(file, (root / file).read_text()))
    chance = random.Random(seed)
    while True:
        file, number = chance.choice(lines)
        if by_operator := of_file(file).get(number):
            yield chance.choice(chance.choice(list(by_operator.values())))


def mutated(mutant: Record, text: str) -> str | None:
    """The text with the change, at the nearest line that reads the same; None if there is none."""
    places, start = [], 0
    for number, line in enumerate(text.split("\n"), start=1):
        place = start + len(line) - len(line.lstrip()) + mutant["column"]
        if line.strip() == mutant["text"] and text.startswith(mutant["before"], place):
            places.append((abs(number - mutant["line"]), place))
        start += len(line) + 1
    if not places:
        return None
    place = min(places)[1]
    return f"{text[:place]}{mutant['after']}{text[place + len(mutant['before']) :]}"


# ---- builds and tests ----


def prepare_tree(commit: str) -> None:
    if not TREE.exists():
        subprocess.run(["git", "clone", "-qsn", ROOT, TREE], check=True)
    subprocess.run(["git", "-C", TREE, "checkout", "-qf", "--detach", commit], check=True)
    configure = ["cmake", "--preset", "release", "-DBALLPISTON_TESTS=ON"]
    # The kernel kills each test when ctest ends.
    configure += ["-DCMAKE_CROSSCOMPILING_EMULATOR=setpriv;--pdeathsig;KILL"]
    subprocess.run(configure, cwd=TREE, check=True, stdout=subprocess.DEVNULL)


def builds(folder: str) -> bool:
    command = ["cmake", "--build", str(TREE / "build/release"), "--target"]
    with (FOLDER / "build.log").open("w") as log:
        return not subprocess.call(
            [*command, *TESTS[folder], *PROGRAMS[folder]], stdout=log, stderr=log
        )


def first_failure(build: Path, folder: str, jobs: int, usual: float) -> str | None:
    """The first test that fails, or the part of a program that crashes or hangs (README.md).
    `usual` is the time of all parts in seconds. A part that fails runs once more, because a busy
    machine can make a test fail too."""
    names = "|".join(TESTS[folder])
    command = ["setpriv", "--pdeathsig", "TERM", "ctest", "--test-dir", str(build)]
    command += ["-R", rf"^({names})\.", "-j", str(jobs)]
    command += ["--timeout", f"{max(SHORTEST_HANG, 3 * usual):.0f}", "--stop-on-failure"]
    command += ["--repeat", "until-pass:2"]
    temporary = tempfile.mkdtemp(prefix="mutation-")  # a test that crashes leaves its files there
    os.chmod(temporary, 0o1777)  # like /tmp: a test is a server of several users
    environment = {**os.environ, "GTEST_FAIL_FAST": "1", "TMPDIR": temporary}
    run = subprocess.run(
        [*command, "--output-on-failure"], env=environment, capture_output=True, text=True
    )
    shutil.rmtree(temporary, ignore_errors=True)
    if run.returncode == 0:
        return None
    (FOLDER / "failure.log").write_text(run.stdout + run.stderr)
    return failure_in(run.stdout)


def failure_in(output: str) -> str:
    """The test that failed twice, by the output of ctest."""
    tests = re.findall(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", output, re.MULTILINE)
    parts = re.findall(r"Test +#\d+: (\S+) \.*([\w ]*\*\*\*\S.*?) +[\d.]+ sec", output)
    if not parts:
        return output.strip().split("\n")[-1]
    part, reason = parts[-1]
    reason = reason.replace("***", " ").strip()
    return str(tests[-1]) if tests and reason == "Failed" else f"{part}: {reason}"


def try_mutant(mutant: Record, jobs: int, usual: float) -> Record:
    file = TREE / mutant["file"]
    original = file.read_text() if file.exists() else ""
    text = mutated(mutant, original)
    if text is None:
        return {**mutant, "result": GONE}
    file.write_text(text)
    try:
        if not builds(folder_of(mutant)):
            return {**mutant, "result": INVALID}
        by = first_failure(TREE / "build/release", folder_of(mutant), jobs, usual)
        return {**mutant, "result": CAUGHT if by else MISSED, "by": by}
    finally:
        file.write_text(original)


def unmutated_seconds(folder: str, jobs: int) -> float:
    """How long the tests take. Without a mutant all must pass; otherwise the run ends here."""
    print(f"the tests of {folder}, without a mutant", flush=True)
    if not builds(folder):
        raise SystemExit(f"{folder} does not build: see {FOLDER}/build.log")
    begin = time.monotonic()
    if by := first_failure(TREE / "build/release", folder, jobs, LONGEST_USUAL):
        raise SystemExit(f"{by} fails without a mutant: see {FOLDER}/failure.log")
    return time.monotonic() - begin


# ---- results: a file with one JSON object a line, and tables ----


def read(path: Path) -> list[Record]:
    """A killed run leaves a part of a line, which is cut off."""
    if not path.exists():
        return []
    whole = path.read_bytes().rpartition(b"\n")[0]
    os.truncate(path, len(whole) + 1 if whole else 0)
    return [json.loads(line) for line in whole.split(b"\n") if line]


def folder_of(record: Record) -> str:
    return str(record["file"]).split("/")[0]


def key(record: Record) -> tuple[Any, ...]:
    return tuple(record[field] for field in MUTANT)


def compiled(records: Iterable[Record]) -> list[Record]:
    return [record for record in records if record.get("result") in (CAUGHT, MISSED)]


def row(record: Record) -> str:
    """For a table in Markdown."""
    change = [record[part].replace("|", "\\|")[:40] for part in ("text", "before", "after")]
    verdict = record["by"] if record["result"] == CAUGHT else f"**{record['result']}**"
    place = f"{record['file']}:{record['line']}"
    shown = "`{}`: `{}` -> `{}`".format(*change).replace("\n", " ")
    return f"| {place} | {record['operator']} | {shown} | {verdict} |"


def table(records: list[Record]) -> str:
    """How many mutants of each folder are caught."""
    lines = ["", "| folder | caught | missed | share caught |", "|---|---|---|---|"]
    for folder in (*TESTS, "all"):
        of_folder = [r for r in compiled(records) if folder in (folder_of(r), "all")]
        caught = sum(record["result"] == CAUGHT for record in of_folder)
        missed = len(of_folder) - caught
        lines.append(f"| {folder} | {caught} | {missed} | {caught / max(len(of_folder), 1):.0%} |")
    return "\n".join(lines)


def lost(earlier: list[Record], now: list[Record]) -> list[Record]:
    """The mutants that are not caught any more."""
    caught = [key(record) for record in earlier if record.get("result") == CAUGHT]
    return [record for record in now if record["result"] == MISSED and key(record) in caught]


# ---- the program ----


def main() -> int:
    parser = argparse.ArgumentParser(description="Measures what the tests protect.")
    parser.add_argument("--count", type=int, default=60, help="mutants that compile (60)")
    parser.add_argument("--seed", type=int, default=1, help="of the drawing (1)")
    parser.add_argument("--commit", default="HEAD", help="whose sources and tests are used (HEAD)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel processes")
    parser.add_argument("--replay", type=Path, metavar="FILE", help="try its mutants again")
    options = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    lock = (FOLDER / "lock").open("w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SystemExit(f"another run uses {FOLDER}") from None
    revision = ["git", "-C", str(ROOT), "rev-parse", "--verify", f"{options.commit}^{{commit}}"]
    commit = subprocess.check_output(revision, text=True).strip()
    earlier = read(options.replay) if options.replay else []
    of = f"of-{options.replay.stem}" if options.replay else str(options.seed)
    path = FOLDER / f"results-{commit[:12]}-{of}.jsonl"
    prepare_tree(commit)
    drawn = iter(compiled(earlier)) if options.replay else draw(TREE, options.seed)
    records = try_all(drawn, len(earlier) or options.count, options.jobs, path)
    print(table(records))
    not_caught = lost(earlier, records)
    if options.replay:
        print(f"\nlost: {len(not_caught)}", *map(row, not_caught), sep="\n")
    return int(len(not_caught) > 0)


def try_all(drawn: Iterator[Record], count: int, jobs: int, path: Path) -> list[Record]:
    """Until so many compiled. Mutants of an earlier, interrupted run are not tried again."""
    known = {key(record): record for record in read(path)}
    usual_of = cache(lambda folder: unmutated_seconds(folder, jobs))
    tried: dict[tuple[Any, ...], Record] = {}
    while len(compiled(tried.values())) < count:
        mutant = next(drawn, None)
        if mutant is None:
            break
        if key(mutant) in tried:
            continue
        record = known.get(key(mutant))
        if not record:
            mutant = {field: mutant[field] for field in MUTANT}
            record = try_mutant(mutant, jobs, usual_of(folder_of(mutant)))
            with path.open("a") as file:
                file.write(json.dumps(record) + "\n")
        tried[key(mutant)] = record
        print(row(record), flush=True)
    return list(tried.values())


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends ctest too
    raise SystemExit(main())
