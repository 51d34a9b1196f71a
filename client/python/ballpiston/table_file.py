"""Named columns in a file: .csv, .npz or .parquet, by its ending."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston.document import whole_file

Table = dict[str, npt.NDArray[Any]]


def write_table(path: Path, table: Table, comment: str = "") -> None:
    """Writes the whole file or none. A .csv file has all digits, and an empty cell for NaN. If
    there is a comment, it is the first line, after a #.

    Raises:
        ModuleNotFoundError: .parquet needs pandas and pyarrow.
    """
    with whole_file(path) as part:
        if path.suffix == ".csv":
            with part.open("w", newline="", encoding="utf-8") as file:
                file.write(f"# {comment}\n" if comment else "")
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(table)
                for row in zip(*(column.tolist() for column in table.values())):
                    writer.writerow(map(_cell, row))
        elif path.suffix == ".npz":
            with part.open("wb") as file_of_arrays:
                np.savez_compressed(file_of_arrays, **table)
        else:
            import pandas

            pandas.DataFrame(table).to_parquet(part, index=False)


def _cell(value: Any) -> Any:
    """The content of the cell: 64 for 64.0, empty for NaN."""
    if not isinstance(value, float):
        return value
    return "" if np.isnan(value) else repr(value).removesuffix(".0")
