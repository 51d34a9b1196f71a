"""What each operator does to a line, and what no operator touches."""

from __future__ import annotations

import unittest

import operators
from cpp_text import CppText


def changed(name: str, line: str) -> list[str]:
    """The line in a function, after each change of this operator."""
    cpp = CppText(f"void F() {{\n{line}\n}}\n")
    changes = list(getattr(operators, name)(cpp))
    starts = [(cpp.tokens[change.first].start, cpp.tokens[change.last].end) for change in changes]
    return [
        (cpp.text[:start] + change.after + cpp.text[end:]).split("\n", 1)[1].rsplit("\n", 2)[0]
        for change, (start, end) in zip(changes, starts)
    ]


class OperatorsTest(unittest.TestCase):
    def check(self, name: str, line: str, *expected: str) -> None:
        self.assertEqual(changed(name, line), list(expected))

    def test_signs_are_flipped(self) -> None:
        self.check("flip_sign", "x = -a + b;", "x = -a - b;", "x = a + b;")
        self.check("flip_sign", "x -= p->y * 1e-3;", "x += p->y * 1e-3;")

    def test_bounds_move_by_one(self) -> None:
        self.check("move_bound", "if (i < n) F();", "if (i <= n) F();", "if (i < 1 + n) F();")
        self.check("move_bound", "std::vector<int> a; b >> 3; c << 2; d->e;")

    def test_comparisons_and_logic_are_inverted(self) -> None:
        self.check("invert_equality", "x = a == b;", "x = a != b;")
        self.check("swap_logic", "x = a && b;", "x = a || b;")
        self.check("swap_logic", "auto&& x = Y();")

    def test_numbers_change(self) -> None:
        self.check("change_number", "x = 19u;", "x = 20u;")
        self.check("change_number", "x = 0.05;", "x = 0.06;")
        self.check("change_number", "x = 9e-7;", "x = 1e-7;")
        self.check("change_number", "x = 0.0;", "x = 1.0;")
        self.check("change_number", "x = 0x1f;", "x = 0x2f;")

    def test_terms_and_statements_are_left_out(self) -> None:
        self.check("drop_term", "sum.Merge(a); n += 2; Run(a); b = 1;",
                   "; n += 2; Run(a); b = 1;", "sum.Merge(a); ; Run(a); b = 1;")  # fmt: skip
        self.check("skip_statement", "sum.Merge(a); n += 2; Run(a);", "sum.Merge(a); n += 2; ;")
        self.check("skip_statement", "if (a) p->q[1].R(b); else *s = {1};",
                   "if (a) ; else *s = {1};", "if (a) p->q[1].R(b); else ;")  # fmt: skip
        self.check("skip_statement", "++n; out << a;", "; out << a;", "++n; ;")

    def test_declarations_are_no_statements(self) -> None:
        for line in ("int a = 1;", "Foo& a = B();", "std::vector<int> a(3);", "return F();",
                     "Foo a;", "Foo(const Foo&) = delete;", "assert(a);"):  # fmt: skip
            self.check("skip_statement", line)

    def test_neighbouring_statements_are_exchanged(self) -> None:
        self.check("swap_statements", "Commit();  // a\nCall(1);", "Call(1);  // a\nCommit();")
        self.check("swap_statements", "if (a) Commit(); Call(1);")

    def test_conditions_are_negated(self) -> None:
        self.check("negate_condition", "if (a || b) F();", "if (!(a || b)) F();")
        self.check("negate_condition", "if (int a = 1; a) F();", "if (int a = 1; !(a)) F();")

    def test_another_value_is_returned(self) -> None:
        self.check("return_wrong", "return true;", "return false;")
        self.check("return_wrong", "return 3;", "return 4;")
        self.check("return_wrong", "return Code::kA; return kB;",
                   "return kB; return kB;", "return Code::kA; return Code::kA;")  # fmt: skip
        self.check("return_wrong", "return F(); return kOnly;")

    def test_labels_change(self) -> None:
        self.check("change_label", 'F("a");', 'F("xa");')
        self.check("change_label", 'F("a", "\\"");',
                   'F("xa", "\\"");', 'F("\\"", "a");', 'F("a", "x\\"");')  # fmt: skip

    def test_nothing_else_is_touched(self) -> None:
        comments = '// x = -1 + "a";\n/* if (a < b)\n F(); */\n'
        directives = '#include "a/b.h"\n  #define X(a) \\\n    a = 1;\n'
        for operator in operators.OPERATORS:
            self.check(operator.__name__, comments + directives)


if __name__ == "__main__":
    unittest.main()
