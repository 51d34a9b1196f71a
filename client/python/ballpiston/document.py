"""Files. A result is the JSON document that `ballpiston result JOB --format json` prints, one point
a line: {"client_version": "...", "job": {...}, "points": [...]}. Messages have the protocol's own
field names; fields with their default value are written too; 64-bit integers are strings, as JSON
of Protocol Buffers has it. A table has named columns: .csv, .npz or .parquet.
"""

import csv
import functools
import inspect
import io
import json
import os
import stat
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from google.protobuf import json_format

from ballpiston._version import __version__
from ballpiston.fields import frame_of
from ballpiston.v1 import ensemble_pb2, result_pb2

# Protocol Buffers 5 renamed the option that writes fields with their default value.
_DEFAULTS_OPTION = (
    "including_default_value_fields"
    if "including_default_value_fields" in inspect.signature(json_format.MessageToDict).parameters
    else "always_print_fields_with_no_presence"
)
Table = dict[str, npt.NDArray[Any]]
_ZIP_MAGIC = b"PK\x03\x04"


def json_of(message: Any) -> dict[str, Any]:
    """A message as JSON."""
    options = {"preserving_proto_field_name": True, _DEFAULTS_OPTION: True}
    document: dict[str, Any] = json_format.MessageToDict(message, **options)
    return document


def document_of(job: Any, points: Sequence[Any]) -> str:
    """The text of the document, one point a line."""
    lines = ",\n".join(json.dumps(json_of(point)) for point in points)
    return (
        f'{{"client_version": {json.dumps(__version__)},\n"job": {json.dumps(json_of(job))},\n'
        f'"points": [\n{lines}\n]}}\n'
    )


def read_document(path: Path) -> tuple[Any, list[Any]]:
    """The job and the points in a file. Raises ValueError: the file has no such document; OSError:
    the file cannot be read."""
    data = path.read_bytes()
    if data.startswith(_ZIP_MAGIC):
        raise ValueError(
            f"{path} contains arrays: numpy.load reads it. ballpiston.load reads the JSON files "
            'that result.save("NAME.json") and ballpiston result JOB --format json write'
        )
    try:
        document = json.loads(data)
        read = functools.partial(json_format.ParseDict, ignore_unknown_fields=True)
        job = read(document["job"], ensemble_pb2.EnsembleJob())
        points = [read(point, result_pb2.PointResult()) for point in document["points"]]
    except (ValueError, KeyError, TypeError, AttributeError, json_format.ParseError) as error:
        raise ValueError(f"{path} is not a saved result: {error!r}") from error
    return job, points


def write_atomically(path: Path, data: bytes) -> None:
    """The whole file or none."""
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file beside `path` to write to. It becomes `path` at the end, and goes after an error, so
    that no half-written result remains. A pipe or a device is written to directly."""
    if path.exists() and not path.is_file():
        yield path
        return
    path = path.resolve()  # symbolic links stay
    umask = os.umask(0o077)
    os.umask(umask)
    mode = path.stat().st_mode if path.exists() else 0o666 & ~umask
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    os.close(descriptor)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(stat.S_IMODE(mode))  # mkstemp's files are private
        temporary.replace(path)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.strerror:  # that of a write names no file
            error.filename = str(path)
        raise


def write_table(path: Path, table: Table, comment: str = "") -> None:
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
            part.write_bytes(npz_of(table))
        else:
            frame_of(table).to_parquet(part, index=False)


def npz_of(table: Table) -> memoryview:
    """The bytes of an .npz file, made in memory: an archive in a file would write to it again
    after a failed write, when Python destroys the archive."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **table)
    return buffer.getbuffer()


def _cell(value: Any) -> Any:
    """The content of the cell: 64 for 64.0, empty for NaN."""
    if not isinstance(value, float):
        return value
    return "" if np.isnan(value) else repr(value).removesuffix(".0")
