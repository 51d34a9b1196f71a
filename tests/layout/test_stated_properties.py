"""Headers list properties of their code, "each with a test of its name" or "the test that bears its
name". These tests exist."""

from __future__ import annotations

import re

from sources import SOURCES


def stated_properties(header: str) -> list[str]:
    """The names in all lists of properties. A list ends with its comment."""
    comments = re.findall(r"^//.*(?:\n//.*)*", header, re.MULTILINE)
    lists = [part for text in comments for part in text.replace("\n//", "").split("its name:")[1:]]
    return re.findall(r"[0-9]\. ([A-Z][a-z]*[A-Z]\w*)", " ".join(lists))


def without_test(names: list[str], tests: str) -> list[str]:
    """The names among these that no test in the sources has."""
    return [name for name in names if f" {name}) {{" not in tests]


def test_stated_properties_have_a_test_of_their_name() -> None:
    is_test = re.compile(r"tests/.*\.cc")
    tests = "".join(text for path, text in SOURCES.items() if is_test.fullmatch(path))
    stated = {
        path: stated_properties(text)
        for path, text in SOURCES.items()
        if path.endswith(".h") and not path.startswith("tests/")
    }
    missing = {path: without_test(names, tests) for path, names in stated.items()}
    assert {path: names for path, names in missing.items() if names} == {}
    assert sum(map(len, stated.values())) > 100


def test_properties_are_read_from_the_lists_to_the_ends_of_their_comments() -> None:
    header = """// A fold. Properties, each with a test of its
// name:
//   1. FirstOne.  2. SecondOne, within 1.5 sigma.
//   3. ThirdOne: as above.
#pragma once
// 4. AnotherComment.
// Property, with the test that bears its name: 1. FourthOne.
"""
    assert stated_properties(header) == ["FirstOne", "SecondOne", "ThirdOne", "FourthOne"]
    assert stated_properties("// 1. NotInAList.\n") == []
    assert without_test(["HasATest", "HasNoTest"], "TEST(Suite, HasATest) {") == ["HasNoTest"]
