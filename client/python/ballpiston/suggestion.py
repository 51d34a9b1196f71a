"""Messages about names that do not exist, with the nearest name that does."""

import difflib
from collections.abc import Iterable


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """'; did you mean NAME?', or nothing if no name is near."""
    near = difflib.get_close_matches(name, list(names), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def no_such(what: str, name: str, owner: str, names: Iterable[str]) -> str:
    """The message that `owner` has no `what` of this name, with the names that `owner` has."""
    names = list(dict.fromkeys(names))
    there = ", ".join(names) or "none"
    return f"there is no {what} {name!r}{did_you_mean(name, names)}; {owner} has {there}"
