"""The programs that some figures run in place of a question to the server (tools/README.md)."""

import csv
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ballpiston.errors import Error, InvalidArgument
from ballpiston.figures.parts.tables import Table
from ballpiston.private_server import find_program


def output_of(program: str, *arguments: str, quiet: bool = False) -> str:
    """What the program prints. Its messages go to standard error; with `quiet` only if it fails.

    Raises:
        Error: it cannot be started or fails. InvalidArgument if it rejects its arguments.
    """
    beside = Path(find_program()).resolve().parent
    hidden = beside.parent / "libexec" / "ballpiston"  # programs that only figures use
    folders = [str(beside), str(hidden), os.environ.get("PATH", "")]
    path = shutil.which(program, path=os.pathsep.join(folders))
    if path is None:
        raise Error(f"{program}: not found beside the program ballpiston, nor in PATH")
    messages = subprocess.PIPE if quiet else None
    ended = subprocess.run(
        [path, *arguments], stdout=subprocess.PIPE, stderr=messages, text=True, check=False
    )
    if ended.returncode != 0:
        sys.stderr.write(ended.stderr or "")
        kind = InvalidArgument if ended.returncode == 2 else Error
        raise kind(f"{program} failed with exit status {ended.returncode}")
    return ended.stdout


def table_of(program: str, *words: str, **flags: Any) -> Table:
    """The table that the program prints, given a command and flags."""
    texts = [f"--{name.replace('_', '-')}={value}" for name, value in flags.items()]
    return read_table(output_of(program, *words, *texts))


def read_table(text: str) -> Table:
    """Of CSV with a line of names: columns of numbers, NaN where absent, or of texts."""
    names, *lines = csv.reader(text.splitlines())
    return {name: _column(cells) for name, cells in zip(names, zip(*lines))}


def _column(cells: Iterable[str]) -> Any:
    try:
        return np.array([float(cell or "nan") for cell in cells])
    except ValueError:
        return np.array(cells)
