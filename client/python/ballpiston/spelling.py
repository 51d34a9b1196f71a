"""The names of the protocol as users write them: first-hit or first_hit for FIRST_HIT."""

from typing import Any

from ballpiston.suggestion import did_you_mean


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
