"""ballpiston export [JOB ...] [--label KEY=VALUE ...] --out FILE

Writes the estimates of jobs to FILE, which ends with .csv, .npz or .parquet. The command line
starts this program after it has checked FILE and the Python modules that FILE needs.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from pathlib import Path

from ballpiston.client import connect
from ballpiston.errors import NotFound
from ballpiston.estimates_table import estimates_table
from ballpiston.program import run_program
from ballpiston.table_file import write_table


def _main(arguments: list[str]) -> list[Path]:
    parser = ArgumentParser(prog="ballpiston export", allow_abbrev=False)
    parser.add_argument("jobs", nargs="*")
    parser.add_argument("--label", action="append", default=[])
    parser.add_argument("--out", required=True, type=Path)
    options = parser.parse_args(arguments)
    labels = dict(label.split("=", 1) for label in options.label)
    with connect() as client:
        named = [client.job(name) for name in options.jobs]
        jobs = named or client.jobs(labels=labels, limit=None)
        if labels and not jobs:
            raise NotFound(f"--label {' --label '.join(options.label)}: no job has these labels")
        write_table(options.out, estimates_table(jobs))
    return [options.out]


if __name__ == "__main__":
    sys.exit(run_program(_main, sys.argv[1:]))
