"""The JSON document of a result, as `ballpiston result JOB --format json` prints it, one point a
line: {"client_version": "...", "job": {...}, "points": [...]}. Messages have the protocol's own
field names; fields with their default value are written too; 64-bit integers are strings, as JSON
of Protocol Buffers has it.
"""

import functools
import inspect
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from google.protobuf import json_format

from ballpiston._version import __version__
from ballpiston.v1 import ensemble_pb2, result_pb2

# The option that writes fields with their default value. It depends on the version.
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
