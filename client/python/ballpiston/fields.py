"""The fields of messages, as Python values and as NumPy arrays, and the names of the protocol as
users write them: FIRST_HIT is first-hit; first_hit is read as well."""

import difflib
from collections.abc import Callable, Iterable
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


def column(messages: Iterable[Any], name: str) -> FloatArray:
    """A field of all messages; NaN where `value_of` has None."""
    return np.array([value_of(message, name) for message in messages], dtype=np.float64)


def frame_of(table: Any) -> Any:
    """A pandas.DataFrame of rows or of columns by name."""
    import pandas

    return pandas.DataFrame(table)


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


def spelling_of_name(name: str) -> str:
    """first-hit of FIRST_HIT."""
    return name.lower().replace("_", "-")


def spelled(message: Any, field: str) -> str:
    """The spelling of an enum in a message. A value that only later versions know is spelled
    as its number."""
    value = getattr(message, field)
    named = message.DESCRIPTOR.fields_by_name[field].enum_type.values_by_number.get(value)
    return str(value) if named is None else spelling_of_name(named.name)


def from_spelling(enum: Any, what: str, text: object) -> int:
    """The number of a spelling. `what` names the argument in the error. Raises TypeError: `text` is
    not a str; ValueError: no value is spelled like this; the message lists the values."""
    if not isinstance(text, str):
        raise TypeError(f"{what} has to be a str, not {type(text).__name__}")
    # All values except the unspecified one.
    numbers = {spelling_of_name(v.name): int(v.number) for v in enum.DESCRIPTOR.values if v.number}
    wanted = spelling_of_name(text)
    if wanted in numbers:
        return numbers[wanted]
    raise ValueError(
        f"{text!r} is not a value of {what}{did_you_mean(wanted, numbers)}; "
        f"the values are {', '.join(numbers)}"
    )


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """'; did you mean NAME?', or nothing if no name is near."""
    near = difflib.get_close_matches(name, list(names), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def no_such(what: str, name: str, owner: str, names: Iterable[str]) -> str:
    """The message that `owner` has no `what` of this name, with the names that `owner` has."""
    names = list(dict.fromkeys(names))
    there = ", ".join(names) or "none"
    return f"there is no {what} {name!r}{did_you_mean(name, names)}; {owner} has {there}"
