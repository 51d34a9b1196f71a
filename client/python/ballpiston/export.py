"""ballpiston export [JOB ...] [--label KEY=VALUE ...] --out FILE

Writes the estimates of jobs to FILE, which ends with .csv, .npz or .parquet.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from importlib import import_module
from pathlib import Path

from ballpiston.client import connect
from ballpiston.errors import NotFound
from ballpiston.estimates_table import estimates_table
from ballpiston.program import run_program
from ballpiston.table_file import write_table

_ENDINGS = (".csv", ".npz", ".parquet")


def _check(path: Path) -> None:
    if path.suffix not in _ENDINGS:
        raise ValueError(f"--out: {path} does not end with {', '.join(_ENDINGS)}")
    if path.suffix == ".parquet":  # before anything is asked
        for module in ("pandas", "pyarrow"):
            import_module(module)


def _main(arguments: list[str]) -> list[Path]:
    parser = ArgumentParser(prog="ballpiston export", allow_abbrev=False)
    parser.add_argument("jobs", nargs="*")
    parser.add_argument("--label", action="append", default=[])
    parser.add_argument("--out", required=True, type=Path)
    options = parser.parse_args(arguments)
    _check(options.out)
    labels = dict(label.split("=", 1) for label in options.label)
    with connect() as client:
        named = [client.job(name) for name in options.jobs]
        jobs = named or client.jobs(labels=labels, limit=None)
        if labels and not jobs:
            raise NotFound(f"--label {' --label '.join(options.label)}: no job has these labels")
        write_table(options.out, estimates_table(jobs))
    return [options.out]


if __name__ == "__main__":
    try:
        sys.exit(run_program(_main, sys.argv[1:]))
    except ModuleNotFoundError as error:
        sys.exit(f"ballpiston: --out FILE.parquet needs the module {error.name}: pip install pyarrow")
