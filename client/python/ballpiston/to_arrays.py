"""python3 -m ballpiston.to_arrays FILE: replaces a saved result by its arrays, as NumPy reads them.

The command line calls this for `--save NAME.npz`, before the file gets this name.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from ballpiston.result import load


def main(path: Path) -> None:
    arrays = load(path).arrays()
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]))
    except OSError as error:  # for instance a full disk
        sys.exit(f"ballpiston: the arrays cannot be written: {error.strerror}")
