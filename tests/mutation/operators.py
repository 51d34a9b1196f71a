"""Small wrong changes of C++ text, found by regular expressions.

The text must be formatted by clang-format: a statement begins its line, the sign of an operation on
two operands has blanks on both sides, and the bracket of a template has not. A change that does not
compile is drawn again.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple


class Change(NamedTuple):
    operator: str
    start: int
    end: int
    after: str


_NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|^[ \t]*#(?:\\\n|[^\n])*|R"([^(\s]*)\(.*?\)\1"'
    r'|"(?:\\.|[^"\\\n])*"' + r"|'(?:\\.|[^'\\\n])'",
    re.MULTILINE | re.DOTALL,
)
_SIGN = re.compile(r"(?<= )(?:[-+<>=!]=|[-+<>]|&&|\|\|)(?=\s)")
_OTHER_SIGNS = {
    "flip sign": {"+": "-", "-": "+", "+=": "-=", "-=": "+="},
    "move bound": {"<": "<=", "<=": "<", ">": ">=", ">=": ">"},
    "shift bound": {sign: f"{sign} 1 +" for sign in ("<", "<=", ">", ">=")},
    "invert equality": {"==": "!=", "!=": "=="},
    "swap logic": {"&&": "||", "||": "&&"},
}
_NEGATIVE = re.compile(r"(?<=[ (\[{])-(?=[\w(])")
_NUMBER = re.compile(r"(?<![\w.'])\d(?:[eEpP][-+]|'(?=\w)|[\w.])*")
# An increment, or an operand such as *a.b->F(x)[1] that is called, assigned or put out. A
# declaration has a type and a blank before its name.
_STATEMENT = re.compile(
    r"(?:(?:^ +|(?<=[;{}] ))|(?P<body>(?<=\) )|(?<=else )))"
    r"(?P<text>(?!(?:[A-Z_]+|assert|static_assert|return)\b)"
    r"(?:(?:\+\+|--)[^;{}=\s]+|[\w*(][\w:.()>\[\]*-]*"
    r"(?:\([^;]*\)|\+\+|--| (?:[-+*/%&|^]|<<)?=(?! default| delete) [^;]*| << [^;]*));)",
    re.MULTILINE,
)
_RETURN = re.compile(r"\breturn ([\w:]+);")
_STRING = re.compile(r'"_*"(?=(?:(,\s*)("_*"))?)')


def changes(text: str) -> Iterator[Change]:
    """All changes of this text."""
    code = _NOT_CODE.sub(_masked, text)
    for sign in _SIGN.finditer(code):
        for operator, others in _OTHER_SIGNS.items():
            if sign[0] in others:
                yield Change(operator, *sign.span(), others[sign[0]])
    for sign in _NEGATIVE.finditer(code):
        yield Change("flip sign", *sign.span(), "")
    for number in _NUMBER.finditer(code):
        yield from _other_number(number[0], number.start())
    for condition in re.finditer(r"\bif (?:constexpr )?\(", code):
        start, end = _last_part(code, condition.end())
        yield Change("negate condition", start, end, f"!({text[start:end]})")
    yield from _of_statements(code, text)
    yield from _of_returned_values(code)
    for string in _STRING.finditer(code):
        yield Change("change label", string.start(), string.start() + 1, '"x')
        if string[2]:  # two of a list are exchanged
            swapped = text[slice(*string.span(2))] + string[1] + text[slice(*string.span())]
            yield Change("change label", string.start(), string.end(2), swapped)


def _masked(found: re.Match[str]) -> str:
    """Blanks for what is no code; a literal is replaced by one of the same length."""
    if found[0][0] in "\"'":
        return found[0][0] + "_" * (len(found[0]) - 2) + found[0][0]
    return re.sub(r"[^\n]", " ", found[0])


def _other_number(number: str, start: int) -> Iterator[Change]:
    """An integer grows by one; the first digit of another number that is not 0 changes."""
    if integer := re.fullmatch(r"(\d+)[uUlL]*", number):
        yield Change("change number", start, start + integer.end(1), str(int(integer[1]) + 1))
    elif digit := re.search(r"[1-9]", number):
        other = str(int(digit[0]) % 9 + 1)
        yield Change("change number", start + digit.start(), start + digit.end(), other)
    elif number.startswith("0."):
        yield Change("change number", start, start + 1, "1")


def _last_part(code: str, start: int) -> tuple[int, int]:
    """From here to the closing bracket, without a part that ends with a semicolon."""
    depth, end = 1, start
    while depth and end < len(code):
        depth += {"(": 1, ")": -1}.get(code[end], 0)
        if code[end] == ";":
            start = end + 2
        end += 1
    return start, end - 1


def _of_statements(code: str, text: str) -> Iterator[Change]:
    """A statement is left out, or exchanged with the next one: a callback before its commit."""
    statements = [  # without the later lines of expressions
        found
        for found in _STATEMENT.finditer(code)
        if found["body"] is not None or code[: found.start("text")].rstrip()[-1:] in ";{}:)"
    ]
    for statement in statements:
        yield Change("skip statement", *statement.span("text"), ";")
    for first, second in pairwise(statements):
        (start, end), (next_start, next_end) = first.span("text"), second.span("text")
        if first["body"] is None and not code[end:next_start].strip():
            swapped = text[next_start:next_end] + text[end:next_start] + text[start:end]
            yield Change("swap statements", start, next_end, swapped)


def _of_returned_values(code: str) -> Iterator[Change]:
    """Another of the constants that this file returns, the other truth value, the next number."""
    found = list(_RETURN.finditer(code))
    constants = sorted({value[1] for value in found if re.search(r"\bk[A-Z]\w*$", value[1])})
    others = dict(zip(constants, constants[1:] + constants[:1]))
    others |= {"true": "false", "false": "true"}
    for value in found:
        other = str(int(value[1]) + 1) if value[1].isdigit() else others.get(value[1], value[1])
        if other != value[1]:
            yield Change("return wrong", *value.span(1), other)
