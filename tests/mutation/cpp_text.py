"""C++ text as tokens, and the statements among them.

This is not a parser: a change that does not compile is drawn again. The text must be formatted by
clang-format: there, the sign of a comparison has spaces on both sides, and the bracket of a
template has not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

_TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<directive>^[ \t]*\#(?:\\\n|[^\n])*)
      | (?P<raw>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)")
      | (?P<string>"(?:\\.|[^"\\\n])*")
      | (?P<character>'(?:\\.|[^'\\\n])+')
      | (?P<number>\.?\d(?:[eEpP][-+]|'(?=\w)|[\w.])*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<sign><=>|<<=?|->|::|\+\+|--|&&|\|\||[-+*/%&|^<>=!]=|[^\s\w])""",
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)
_CLOSES = {")": "(", "]": "[", "}": "{"}
_ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<="}
_KEYWORDS = set(
    "assert break case continue default delete do else for friend if namespace operator return"
    " sizeof static_assert switch template throw try using while".split()
)


class Token(NamedTuple):
    kind: str
    text: str
    start: int
    end: int


class Statement(NamedTuple):
    """A call, an assignment or an output: its first token and its semicolon."""

    first: int
    last: int
    name: str  # of the last function called, or the operator
    is_body: bool  # of an if or a loop, without braces


class CppText:
    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [
            Token(match.lastgroup or "", match[0], match.start(), match.end())
            for match in _TOKEN.finditer(text)
            if match.lastgroup not in ("comment", "directive")
        ]
        self.closing: dict[int, int] = {}  # the closing bracket of each opening one
        opened = []
        for i, token in enumerate(self.tokens):
            if token.text in _CLOSES.values():
                opened.append(i)
            elif token.text in _CLOSES and opened:
                self.closing[opened.pop()] = i
        self._opening = {closing: opening for opening, closing in self.closing.items()}

    def word(self, i: int) -> str:
        return self.tokens[i].text if 0 <= i < len(self.tokens) else ""

    def kind(self, i: int) -> str:
        return self.tokens[i].kind if 0 <= i < len(self.tokens) else ""

    def between(self, first: int, last: int) -> str:
        return self.text[self.tokens[first].start : self.tokens[last].end]

    def is_spaced(self, i: int) -> bool:
        """True for the sign of an operation on two operands."""
        before, after = self.tokens[i].start - 1, self.tokens[i].end
        return self.text[before : before + 1].isspace() and self.text[after : after + 1].isspace()

    def statements(self) -> Iterator[Statement]:
        for i in range(1, len(self.tokens)):
            is_body = self._is_condition(i - 1) or self.word(i - 1) in ("else", "do")
            if is_body or self.word(i - 1) in (";", "{", "}") or self._is_label(i - 1):
                last, name = self._statement(i)
                if name and self.word(last) == ";":
                    yield Statement(i, last, name, is_body)

    def _is_condition(self, i: int) -> bool:
        before = self._opening.get(i, 0) - 1
        return self.word(i) == ")" and self.word(before) in ("if", "for", "while", "constexpr")

    def _is_label(self, i: int) -> bool:
        line = self.text[: self.tokens[i].end].rsplit("\n", 1)[-1].strip()
        return self.word(i) == ":" and line.startswith(("case ", "default:"))

    def _statement(self, i: int) -> tuple[int, str]:
        i, name = self._operand(i)
        if self.word(i) in ("++", "--"):
            return i + 1, self.word(i)
        is_default = self.word(i + 1) in ("default", "delete")
        if self.word(i) in _ASSIGNMENTS | {"<<"} and not is_default:
            name = self.word(i)
            while self.word(i) not in (";", "}", ""):
                i = self._after(i)
        return i, name

    def _operand(self, i: int) -> tuple[int, str]:
        """The index after an operand such as `*a.b->F(x)[1]`, and its last call or increment."""
        name = self.word(i) if self.word(i) in ("++", "--") else ""
        while self.word(i) in ("++", "--", "*", "("):
            i = self._after(i) if self.word(i) == "(" else i + 1
        if self.word(i) in _KEYWORDS or self.word(i).isupper():  # capitals: a macro
            return i, ""
        word = ""
        while True:
            if self.kind(i) == "word" and self.kind(i + 1) != "word":
                word, i = self.word(i), i + 1
            elif self.word(i) in ("::", ".", "->"):
                i += 1
            elif self.word(i) in ("(", "[") and word:
                name = word if self.word(i) == "(" else name
                i = self._after(i)
            else:
                return i, name

    def _after(self, i: int) -> int:
        return self.closing.get(i, i) + 1
