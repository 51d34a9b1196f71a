"""The fields of messages, as Python values, as NumPy arrays and as JSON, and the names of enums as
users write them: first-hit or first_hit for FIRST_HIT."""

import inspect
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
from google.protobuf import json_format

from ballpiston.suggestion import did_you_mean

# The option that writes fields with their default value. It depends on the version.
_DEFAULTS_OPTION = (
    "including_default_value_fields"
    if "including_default_value_fields" in inspect.signature(json_format.MessageToDict).parameters
    else "always_print_fields_with_no_presence"
)

FloatArray = npt.NDArray[np.float64]
Value = TypeVar("Value")


def value_of(message: Any, name: str) -> Any:
    """The value of a field; None if it is absent, or if there is no message."""
    if message is None:
        return None
    field = message.DESCRIPTOR.fields_by_name[name]
    is_absent = field.has_presence and not message.HasField(name)
    return None if is_absent else getattr(message, name)


def shown(read: Callable[[Any], Value], doc: str, of: str = "message") -> Value:
    """A property: what the function reads in `self.message`, or in another attribute."""
    return property(lambda self: read(getattr(self, of)), doc=doc)  # type: ignore[return-value]


def column(messages: Iterable[Any], name: str) -> FloatArray:
    """A field of all messages; NaN where `value_of` has None."""
    return np.array([value_of(message, name) for message in messages], dtype=np.float64)


def record_of(message: Any) -> dict[str, Any]:
    """The fields by name. Optional fields and messages that are absent are left out; values of
    enums are their names."""
    record: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if field.label == field.LABEL_REPEATED:
            record[field.name] = [_item(field, item) for item in value]
        elif not field.has_presence or message.HasField(field.name):
            record[field.name] = _item(field, value)
    return record


def _item(field: Any, value: Any) -> Any:
    if field.message_type is not None:
        return record_of(value)
    if field.enum_type is not None:
        named = field.enum_type.values_by_number.get(value)
        return value if named is None else named.name
    return value


def json_of(message: Any) -> dict[str, Any]:
    """A message as JSON."""
    options = {"preserving_proto_field_name": True, _DEFAULTS_OPTION: True}
    document: dict[str, Any] = json_format.MessageToDict(message, **options)
    return document


def _spelling(name: str) -> str:
    """first-hit of FIRST_HIT."""
    return name.lower().replace("_", "-")


def spelled(message: Any, field: str) -> str:
    """The spelling of an enum in a message. A value that only later versions know is spelled
    as its number."""
    value = getattr(message, field)
    named = message.DESCRIPTOR.fields_by_name[field].enum_type.values_by_number.get(value)
    return str(value) if named is None else _spelling(named.name)


def from_spelling(message: Any, field: str, text: object) -> int:
    """The number for an enum in a message, or in a class of messages. Raises TypeError: `text` is
    not a str; ValueError: no value is spelled like this; the message lists the values."""
    if not isinstance(text, str):
        raise TypeError(f"{field} has to be a str, not {type(text).__name__}")
    values = message.DESCRIPTOR.fields_by_name[field].enum_type.values
    # All except the unspecified one.
    numbers = {_spelling(value.name): int(value.number) for value in values if value.number}
    wanted = _spelling(text)
    if wanted in numbers:
        return numbers[wanted]
    raise ValueError(
        f"{text!r} is not a value of {field}{did_you_mean(wanted, numbers)}; "
        f"the values are {', '.join(numbers)}"
    )
