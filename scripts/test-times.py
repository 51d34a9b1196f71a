#!/usr/bin/env python3
"""Prints the processor time of each GoogleTest program, and of the 20 slowest tests.

    scripts/test-times.py [FOLDER_OF_THE_BUILD]

The tests write their times into FOLDER_OF_THE_BUILD/test-times (tests/support/test_main.cc); `make
test` empties this folder first. The times include the programs that a test started and that have
ended.
"""

import collections
import json
import pathlib
import sys


def tests_of(report):
    """Name and processor seconds of each test in a report of GoogleTest."""
    for suite in json.loads(report.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            yield f"{suite['name']}.{test['name']}", float(test.get("processor_seconds", 0))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/release") / "test-times"
    totals = collections.Counter()
    tests = []
    for report in folder.glob("*.json"):
        program = report.name.split(".")[0]
        for name, seconds in tests_of(report):
            totals[program] += seconds
            tests.append((seconds, program, name))
    print("processor seconds of each program")
    for program, seconds in totals.most_common():
        print(f"{seconds:8.1f} {program}")
    print(f"{totals.total():8.1f} in all\n\nprocessor seconds of the slowest tests")
    for seconds, program, name in sorted(tests, reverse=True)[:20]:
        print(f"{seconds:8.2f} {program} {name}")


if __name__ == "__main__":
    main()
