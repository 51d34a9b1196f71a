"""What each operator does to a line, what it leaves alone, and what becomes of a run."""

from __future__ import annotations

import itertools
import stat
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import mutation
import operators

# Each line, and all that one operator makes of it.
CHANGES: list[tuple[str, str, list[str]]] = [
    ("flip sign", "x = -a + b;", ["x = -a - b;", "x = a + b;"]),
    ("flip sign", "x -= p->y * 1e-3;", ["x += p->y * 1e-3;"]),
    ("move bound", "if (i < n) F();", ["if (i <= n) F();"]),
    ("shift bound", "if (i < n) F();", ["if (i < 1 + n) F();"]),
    ("move bound", "std::vector<int> a; b >> 3; c << 2; d->e;", []),
    ("invert equality", "x = a == b;", ["x = a != b;"]),
    ("swap logic", "x = a && b;", ["x = a || b;"]),
    ("swap logic", "auto&& x = Y();", []),
    ("change number", "x = 19u;", ["x = 20u;"]),
    ("change number", "x = 0.05;", ["x = 0.06;"]),
    ("change number", "x = 9e-7;", ["x = 1e-7;"]),
    ("change number", "x = 0.0;", ["x = 1.0;"]),
    ("change number", "x = 0x1f;", ["x = 0x2f;"]),
    ("skip statement", "sum.Merge(a);\nn += 2;", [";\nn += 2;", "sum.Merge(a);\n;"]),
    ("skip statement", "if (a) p->q[1].R(b);\nelse *s = {1};",
     ["if (a) ;\nelse *s = {1};", "if (a) p->q[1].R(b);\nelse ;"]),
    ("skip statement", "++n;\nout << a;", [";\nout << a;", "++n;\n;"]),
    ("skip statement", "int a = 1;\nFoo& a = B();\nFoo a;\nFoo(const Foo&) = delete;\n"
     "std::vector<int> a(3);\nassert(a);\nreturn F();\nx(1 +\n  F(2)) + 3;", []),
    ("swap statements", "Commit();  // a\nCall(1);", ["Call(1);  // a\nCommit();"]),
    ("swap statements", "if (a) Commit();\nCall(1);", []),
    ("negate condition", "if (a || b(c)) F();", ["if (!(a || b(c))) F();"]),
    ("negate condition", "if (int a = 1; a) F();", ["if (int a = 1; !(a)) F();"]),
    ("return wrong", "return true;", ["return false;"]),
    ("return wrong", "return 3;", ["return 4;"]),
    ("return wrong", "return Code::kA; return kB;",
     ["return kB; return kB;", "return Code::kA; return Code::kA;"]),
    ("return wrong", "return F(); return kOnly;", []),
    ("change label", 'F("a");', ['F("xa");']),
    ("change label", 'F("a", "\\"");', ['F("xa", "\\"");', 'F("\\"", "a");', 'F("a", "x\\"");']),
]  # fmt: skip
NO_CODE = """// x = -1 + "a";
/* if (a < b)
  F(); */
#include "a/b.h"
  #define X(a) \\
    a = 1;
"""


class OperatorsTest(unittest.TestCase):
    def test_each_operator_makes_its_changes_alone(self) -> None:
        for operator, lines, expected in CHANGES:
            text = "void F() {\n  " + lines.replace("\n", "\n  ") + "\n}\n"
            found = [
                (text[: change.start] + change.after + text[change.end :])[13:-3]
                for change in operators.changes(text)
                if change.operator == operator
            ]
            with self.subTest(operator, lines=lines):
                self.assertEqual([change.replace("\n  ", "\n") for change in found], expected)

    def test_comments_and_directives_stay(self) -> None:
        self.assertEqual(list(operators.changes(NO_CODE)), [])


class MutantsTest(unittest.TestCase):
    def test_a_mutant_is_found_again_at_the_nearest_line_that_reads_the_same(self) -> None:
        text = "  a = 1;\n\n\n  a = 1;\n  b = 3;\n"
        (mutant,) = mutation.mutants("f", text)[4]["change number"]
        self.assertEqual(mutation.mutated(mutant, text), "  a = 1;\n\n\n  a = 2;\n  b = 3;\n")
        self.assertEqual(mutation.mutated(mutant, "    a = 1;\n"), "    a = 2;\n")
        self.assertIsNone(mutation.mutated(mutant, "  c = 1;\n"))

    def test_a_seed_draws_the_same_mutants_again(self) -> None:
        first, again, other = (
            list(itertools.islice(mutation.draw(mutation.ROOT, seed), 3)) for seed in (1, 1, 2)
        )
        self.assertEqual(first, again)
        self.assertNotEqual(first, other)


class RunsTest(unittest.TestCase):
    """A folder with tests for ctest, in which shell scripts stand for test programs."""

    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.enterContext(mock.patch.object(mutation, "FOLDER", self.folder))

    def first_failure(self, script: str, parts: int = 2, usual: float = 100) -> str | None:
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\nfolder={self.folder}\n{script}")
        program.chmod(stat.S_IRWXU)
        tests = [f"add_test(client_test.{part} {program} {part})\n" for part in range(1, parts + 1)]
        (self.folder / "CTestTestfile.cmake").write_text("".join(tests))
        return mutation.first_failure(self.folder, "client", jobs=2, usual=usual)

    def test_a_part_that_fails_once_is_no_failure(self) -> None:
        self.assertIsNone(self.first_failure('mkdir "$folder/$1" 2>/dev/null && exit 1\nexit 0'))

    def test_the_failed_test_is_named_and_logged(self) -> None:
        script = '[ "$1" = 2 ] || exit 0\necho "[  FAILED  ] Suite.Wrong"\nexit 1'
        self.assertEqual(self.first_failure(script), "Suite.Wrong")
        self.assertIn("Suite.Wrong", (self.folder / "failure.log").read_text())

    def test_crashes_and_hangs_are_named_by_their_part(self) -> None:
        crash = '[ "$1" = 1 ] || exit 0\nkill -SEGV $$'
        self.assertEqual(self.first_failure(crash), "client_test.1: Exception: SegFault")
        with mock.patch.object(mutation, "SHORTEST_HANG", 1):
            hang = self.first_failure("exec sleep 1000", parts=1, usual=0.1)
        self.assertEqual(hang, "client_test.1: Timeout")

    def test_a_run_goes_on_after_the_last_whole_line(self) -> None:
        path = self.folder / "results"
        path.write_text('{"line": 1}\n{"file": "core')
        self.assertEqual(mutation.read(path), [{"line": 1}])
        self.assertEqual(path.read_text(), '{"line": 1}\n')

    def test_a_mutant_that_was_caught_and_is_missed_is_lost(self) -> None:
        mutant: mutation.Record = {**dict.fromkeys(mutation.MUTANT, ""), "by": None}
        caught = [{**mutant, "result": mutation.CAUGHT}]
        missed = [{**mutant, "result": mutation.MISSED}]
        self.assertEqual(mutation.lost(caught, missed), missed)
        self.assertEqual(mutation.lost(missed, caught) + mutation.lost(missed, missed), [])


if __name__ == "__main__":
    unittest.main()
