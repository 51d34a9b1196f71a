"""What counts as a failure of a test program, for which shell scripts stand; and the file of
results."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import running_tests
import table

PARTS = running_tests._PARTS
RUN = 'echo "[ RUN      ] Suite.Test$GTEST_SHARD_INDEX"\n'
FIRST_TIME = 'mkdir "$folder/$GTEST_SHARD_INDEX" 2>/dev/null'
HANG = 'echo started >>"$folder/hanging"; sleep 1000\n'


class FirstFailureTest(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.log = self.folder / "log"

    def first_failure(self, script: str) -> str | None:
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\nfolder={self.folder}\n{script}")
        program.chmod(0o700)
        # The time limit of 5 s is exceeded as soon as all parts hang, and not before.
        with mock.patch.object(running_tests.time, "monotonic", lambda: 10 * self.hangs()):
            return running_tests.first_failure([program], PARTS, 5, self.log)

    def hangs(self) -> int:
        """How often all parts hung."""
        file = self.folder / "hanging"
        return len(file.read_text().split()) // PARTS if file.exists() else 0

    def test_a_part_that_fails_once_is_no_failure(self) -> None:
        self.assertIsNone(self.first_failure(f"{FIRST_TIME} && exit 1\nexit 0"))

    def test_the_failed_test_is_named_and_logged(self) -> None:
        failed = f'{RUN}echo "[  FAILED  ] Suite.Wrong"\nexit 1'
        script = f'[ "$GTEST_SHARD_INDEX" = 2 ] || exit 0\n{failed}'
        self.assertEqual(self.first_failure(script), "Suite.Wrong")
        self.assertIn("Suite.Test2", self.log.read_text())

    def test_a_crash_is_named_after_the_last_test(self) -> None:
        crash = f'[ "$GTEST_SHARD_INDEX" = 3 ] || exit 0\n{RUN}kill -SEGV $$'
        self.assertEqual(self.first_failure(crash), "Suite.Test3 (exit status -11)")

    def test_a_second_hang_names_the_tests_that_run(self) -> None:
        names = ", ".join(f"Suite.Test{i}" for i in range(PARTS))
        self.assertEqual(self.first_failure(RUN + HANG), f"hang: {names}")
        self.assertEqual(self.hangs(), 2)

    def test_an_endless_loop_ends_by_its_processor_time(self) -> None:
        loop = f'[ "$GTEST_SHARD_INDEX" = 1 ] || exit 0\n{RUN}while :; do :; done'
        self.assertEqual(self.first_failure(loop), "Suite.Test1 (exit status -24)")


class ResultsTest(unittest.TestCase):
    def test_a_run_goes_on_after_the_last_whole_line(self) -> None:
        with tempfile.NamedTemporaryFile("w") as file:
            file.write('{"seed": 1}\n{"file": "core')
            file.flush()
            table.Results(Path(file.name), {"seed": 1}).add({"line": 2})
            self.assertEqual(table.read(Path(file.name)), [{"seed": 1}, {"line": 2}])


if __name__ == "__main__":
    unittest.main()
