"""The operators: each finds its small wrong changes in a text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

from cpp_text import CppText, Statement


class Change(NamedTuple):
    """Replaces the tokens from `first` to `last`."""

    first: int
    last: int
    after: str


Changes = Iterator[Change]


def flip_sign(cpp: CppText) -> Changes:
    flipped = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
    yield from _exchange(cpp, flipped)
    for i in range(len(cpp.tokens) - 1):
        if cpp.word(i) == "-" and cpp.tokens[i].end == cpp.tokens[i + 1].start:  # of one operand
            yield Change(i, i + 1, cpp.word(i + 1))


def move_bound(cpp: CppText) -> Changes:
    moved = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
    yield from _exchange(cpp, moved)
    for i, token in enumerate(cpp.tokens):
        if token.text in moved and cpp.is_spaced(i):
            yield Change(i, i, f"{token.text} 1 +")


def invert_equality(cpp: CppText) -> Changes:
    return _exchange(cpp, {"==": "!=", "!=": "=="})


def swap_logic(cpp: CppText) -> Changes:
    return _exchange(cpp, {"&&": "||", "||": "&&"})


def change_number(cpp: CppText) -> Changes:
    """An integer grows by one; the first digit of another number that is not 0 changes."""
    for i, token in enumerate(cpp.tokens):
        if token.kind != "number":
            continue
        if integer := re.fullmatch(r"(\d+)([uUlL]*)", token.text):
            yield Change(i, i, f"{int(integer[1]) + 1}{integer[2]}")
        elif digit := re.search(r"[1-9]", token.text[2 * token.text.startswith("0x") :]):
            at = token.text.index(digit[0])
            other = str(int(digit[0]) % 9 + 1)
            yield Change(i, i, token.text[:at] + other + token.text[at + 1 :])
        elif token.text.startswith("0."):
            yield Change(i, i, "1" + token.text[1:])


def drop_term(cpp: CppText) -> Changes:
    for statement in cpp.statements():
        if _is_term(statement):
            yield Change(statement.first, statement.last, ";")


def skip_statement(cpp: CppText) -> Changes:
    for statement in cpp.statements():
        if not _is_term(statement):
            yield Change(statement.first, statement.last, ";")


def swap_statements(cpp: CppText) -> Changes:
    """For example a callback before its commit."""
    by_first = {statement.first: statement for statement in cpp.statements()}
    for first in by_first.values():
        second = by_first.get(first.last + 1)
        if second and not first.is_body:
            yield _swap(cpp, first.first, first.last, second.first, second.last)


def negate_condition(cpp: CppText) -> Changes:
    for i in range(1, len(cpp.tokens)):
        if cpp.word(i) == "(" and cpp.word(i - 1) in ("if", "constexpr") and i in cpp.closing:
            last = cpp.closing[i] - 1
            first = max(j for j in range(i, last) if j == i or cpp.word(j) == ";") + 1
            yield Change(first, last, f"!({cpp.between(first, last)})")


def return_wrong(cpp: CppText) -> Changes:
    """Another of the constants that this file returns, the other truth value, the next number."""
    constants = {end: cpp.between(i + 1, end) for i, end in _returned(cpp)}
    others = sorted(set(constants.values()))
    truth = {"true": "false", "false": "true"}
    for i, end in _returned(cpp):
        value = constants[end]
        if value in truth:
            yield Change(i + 1, end, truth[value])
        elif value.isdigit():
            yield Change(i + 1, end, str(int(value) + 1))
        elif re.search(r"\bk[A-Z]\w*$", value):
            names = [other for other in others if re.search(r"\bk[A-Z]\w*$", other)]
            if len(names) > 1:
                yield Change(i + 1, end, names[(names.index(value) + 1) % len(names)])


def change_label(cpp: CppText) -> Changes:
    """Changes a string literal, or exchanges two of a list."""
    for i, token in enumerate(cpp.tokens):
        if token.kind != "string":
            continue
        yield Change(i, i, '"x' + token.text[1:])
        if cpp.word(i + 1) == "," and cpp.kind(i + 2) == "string":
            yield _swap(cpp, i, i, i + 2, i + 2)


OPERATORS: list[Callable[[CppText], Changes]] = [
    flip_sign,
    move_bound,
    invert_equality,
    swap_logic,
    change_number,
    drop_term,
    skip_statement,
    swap_statements,
    negate_condition,
    return_wrong,
    change_label,
]


def _exchange(cpp: CppText, partners: dict[str, str]) -> Changes:
    for i, token in enumerate(cpp.tokens):
        if token.kind == "sign" and token.text in partners and cpp.is_spaced(i):
            yield Change(i, i, partners[token.text])


def _swap(cpp: CppText, first: int, last: int, second: int, end: int) -> Change:
    between = cpp.text[cpp.tokens[last].end : cpp.tokens[second].start]
    return Change(first, end, cpp.between(second, end) + between + cpp.between(first, last))


def _is_term(statement: Statement) -> bool:
    return statement.name == "+=" or statement.name.startswith(("Add", "Merge"))


def _returned(cpp: CppText) -> Iterator[tuple[int, int]]:
    """Of each returned name or number: the index of `return`, and the last token."""
    for i in range(len(cpp.tokens)):
        end = i + 1
        while cpp.word(end + 1) == "::":
            end += 2
        if cpp.word(i) == "return" and cpp.word(end + 1) == ";":
            yield i, end
