"""The file of results."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import table


class ResultsTest(unittest.TestCase):
    def test_a_run_goes_on_after_the_last_whole_line(self) -> None:
        with tempfile.NamedTemporaryFile("w") as file:
            file.write('{"seed": 1}\n{"file": "core')
            file.flush()
            table.Results(Path(file.name), {"seed": 1}).add({"line": 2})
            self.assertEqual(table.read(Path(file.name)), [{"seed": 1}, {"line": 2}])


if __name__ == "__main__":
    unittest.main()
