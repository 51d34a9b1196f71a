"""A result as a JSON document, the one that `ballpiston result JOB --format json` prints:

    {"client_version": "...",
    "job": {...},
    "points": [
    {...},
    {...}
    ]}

Messages have the protocol's own field names; fields with their default value are written too;
64-bit integers are strings, as JSON of Protocol Buffers has it.
"""

from __future__ import annotations

import inspect
import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from google.protobuf import json_format

from ballpiston._version import __version__
from ballpiston.v1 import ensemble_pb2, result_pb2

# Protocol Buffers 5 renamed the option that writes fields with their default value.
_DEFAULTS_OPTION = (
    "including_default_value_fields"
    if "including_default_value_fields" in inspect.signature(json_format.MessageToDict).parameters
    else "always_print_fields_with_no_presence"
)
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
    """The job and the points in a file.

    Raises:
        ValueError: the file has no such document.
        OSError: the file cannot be read.
    """
    data = path.read_bytes()
    if data.startswith(_ZIP_MAGIC):
        raise ValueError(
            f"{path} contains arrays: numpy.load reads it. ballpiston.load reads the JSON files "
            'that result.save("NAME.json") and ballpiston result JOB --format json write'
        )
    try:
        document = json.loads(data)
        job = _parsed(document["job"], ensemble_pb2.EnsembleJob())
        points = [_parsed(point, result_pb2.PointResult()) for point in document["points"]]
    except (ValueError, KeyError, TypeError, json_format.ParseError) as error:
        raise ValueError(f"{path} is not a saved result: {error!r}") from error
    return job, points


def write_atomically(path: Path, data: bytes) -> None:
    """Writes a file beside `path` and renames it, so that no half-written result remains."""
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        temporary.chmod(0o666 & ~_current_umask())  # mkstemp's files are private
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _parsed(value: Any, message: Any) -> Any:
    return json_format.ParseDict(value, message, ignore_unknown_fields=True)


def _current_umask() -> int:
    umask = os.umask(0o077)
    os.umask(umask)
    return umask
