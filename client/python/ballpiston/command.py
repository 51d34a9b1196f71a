"""python3 -m ballpiston.command VERB FILE [WORD ...]: the parts of the command line in Python.

    export OUT [JOB ... | KEY=VALUE ...]    writes the estimates of jobs
    sample OUT SPECIFICATION                writes the collisions of a point's samples
    arrays FILE                             replaces a saved result by its arrays (--save NAME.npz)

OUT ends with .csv, .npz or .parquet. The command line starts this program after it has checked the
file and the Python modules that the file needs.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

from ballpiston.client import connect
from ballpiston.errors import NotFound
from ballpiston.estimates_table import estimates_table
from ballpiston.program import run_program
from ballpiston.result import load
from ballpiston.table_file import npz_of, write_table


def _export(out: Path, *words: str) -> list[Path]:
    labels = dict(word.split("=", 1) for word in words if "=" in word)
    with connect() as client:
        named = [client.job(word) for word in words if "=" not in word]
        jobs = named or client.jobs(labels=labels, limit=None)
        if labels and not jobs:
            raise NotFound(f"--label {' --label '.join(words)}: no job has these labels")
        write_table(out, estimates_table(jobs))
    return [out]


def _sample(out: Path, specification: str) -> list[Path]:
    with connect() as client:
        records = client.sample(json.loads(specification)).all()
    write_table(out, {name: records[name] for name in records.dtype.names or ()})
    return [out]


def _arrays(file: Path) -> list[Path]:
    file.write_bytes(npz_of(load(file).arrays()))
    return []  # the client prints the final name


def _main(arguments: list[str]) -> list[Path]:
    verb, file, *words = arguments
    verbs: dict[str, Callable[..., list[Path]]]
    verbs = {"export": _export, "sample": _sample, "arrays": _arrays}
    return verbs[verb](Path(file), *words)


if __name__ == "__main__":
    sys.exit(run_program(_main, sys.argv[1:]))
