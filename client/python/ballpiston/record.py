"""Messages as plain dicts of Python values, quickly: for traces and the state of the server."""

from __future__ import annotations

from typing import Any


def record_of(message: Any) -> dict[str, Any]:
    """The fields by name. Optional fields and messages that are absent are left out; values of
    enums are their names."""
    record: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if field.label == field.LABEL_REPEATED:
            record[field.name] = [_value(field, item) for item in value]
        elif not field.has_presence or message.HasField(field.name):
            record[field.name] = _value(field, value)
    return record


def _value(field: Any, value: Any) -> Any:
    if field.message_type is not None:
        if field.message_type.full_name == "google.protobuf.Timestamp":
            return value.ToJsonString()
        return record_of(value)
    if field.enum_type is not None:
        named = field.enum_type.values_by_number.get(value)
        return value if named is None else named.name
    return value
