"""ballpiston sample EXPERIMENT ... --out FILE: python3 -m ballpiston.sample SPECIFICATION --out FILE

Writes the collisions of a point's samples to FILE, .npz (one array a column) or .parquet. The
command line starts this program after it has checked FILE and the Python modules that FILE needs.
"""

from __future__ import annotations

import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from ballpiston.client import connect
from ballpiston.program import run_program
from ballpiston.table_file import write_table


def _main(arguments: list[str]) -> list[Path]:
    parser = ArgumentParser(prog="ballpiston sample", allow_abbrev=False)
    parser.add_argument("specification", type=json.loads)
    parser.add_argument("--out", required=True, type=Path)
    options = parser.parse_args(arguments)
    with connect() as client:
        records = client.sample(options.specification).all()
    write_table(options.out, {name: records[name] for name in records.dtype.names or ()})
    return [options.out]


if __name__ == "__main__":
    sys.exit(run_program(_main, sys.argv[1:]))
