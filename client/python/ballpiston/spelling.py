"""Names of the protocol as users write them: FIRST_HIT is first-hit; first_hit is read as well."""

from __future__ import annotations

from typing import Any

from ballpiston.suggestion import did_you_mean


def spelling_of_name(name: str) -> str:
    """first-hit of FIRST_HIT."""
    return name.lower().replace("_", "-")


def spelling(enum: Any, value: int) -> str:
    """The spelling of a number of a generated enum. A value of a later version is its number."""
    descriptor = enum.DESCRIPTOR.values_by_number.get(value)
    return str(value) if descriptor is None else spelling_of_name(descriptor.name)


def spellings(enum: Any) -> list[str]:
    """Those of every value but the unspecified one."""
    return [spelling_of_name(value.name) for value in enum.DESCRIPTOR.values if value.number != 0]


def from_spelling(enum: Any, what: str, text: object) -> int:
    """The number of a spelling. `what` names the argument in the error.

    Raises:
        TypeError: `text` is not a str.
        ValueError: no value is spelled like this; the message lists the values.
    """
    if not isinstance(text, str):
        raise TypeError(f"{what} has to be a str, not {type(text).__name__}")
    wanted = spelling_of_name(text)
    for value in enum.DESCRIPTOR.values:
        if value.number != 0 and spelling_of_name(value.name) == wanted:
            return int(value.number)
    names = spellings(enum)
    raise ValueError(
        f"{text!r} is not a value of {what}{did_you_mean(wanted, names)}; "
        f"the values are {', '.join(names)}"
    )
