"""The fields of messages, as Python values and as NumPy arrays."""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

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


def shown_once(read: Callable[[Any], Value], doc: str, of: str = "message") -> Value:
    """`shown`, but the function reads once for each object."""
    once = cached_property(lambda self: read(getattr(self, of)))
    once.__doc__ = doc
    return once  # type: ignore[return-value]


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
        if field.message_type.full_name == "google.protobuf.Timestamp":
            return value.ToJsonString()
        return record_of(value)
    if field.enum_type is not None:
        named = field.enum_type.values_by_number.get(value)
        return value if named is None else named.name
    return value
