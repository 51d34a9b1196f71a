"""Tables of named columns, in files (.csv, .npz or .parquet) and as data frames; and rows of texts
as HTML."""

import csv
import io
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ballpiston.whole_file import whole_file

Table = dict[str, npt.NDArray[Any]]


def frame_of(table: Any) -> Any:
    """A pandas.DataFrame of rows or of columns by name."""
    import pandas

    return pandas.DataFrame(table)


def html_table(heading: str, titles: Iterable[str], rows: Sequence[Iterable[str]]) -> str:
    """Heading and rows as HTML. Every text is escaped."""

    def line(tag: str, texts: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts) + "</tr>"

    body = "".join(line("td", row) for row in rows)
    head = line("th", titles)
    table = f"<table><thead>{head}</thead><tbody>{body}</tbody></table>" if rows else ""
    return f"<p>{escape(heading)}</p>{table}"


def write_table(path: Path, table: Table, comment: str = "", compressed: bool = True) -> None:
    """Writes the whole file or none. A .csv file has all digits, and an empty cell for NaN. If
    there is a comment, it is the first line, after a #. Raises ModuleNotFoundError: .parquet needs
    pandas and pyarrow."""
    with whole_file(path) as part:
        if path.suffix == ".csv":
            with part.open("w", newline="", encoding="utf-8") as file:
                file.write(f"# {comment}\n" if comment else "")
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(table)
                for row in zip(*(column.tolist() for column in table.values())):
                    writer.writerow(map(_cell, row))
        elif path.suffix == ".npz":
            part.write_bytes(npz_of(table, compressed))
        else:
            frame_of(table).to_parquet(part, index=False)


def npz_of(table: Table, compressed: bool = True) -> memoryview:
    """The bytes of an .npz file, made in memory: an archive in a file would write to it again
    after a failed write, when Python destroys the archive."""
    buffer = io.BytesIO()
    (np.savez_compressed if compressed else np.savez)(buffer, **table)
    return buffer.getbuffer()


def _cell(value: Any) -> Any:
    """The content of the cell: 64 for 64.0, empty for NaN."""
    if not isinstance(value, float):
        return value
    return "" if np.isnan(value) else repr(value).removesuffix(".0")
