"""The files that name the version of the project, its date or the engine's version agree."""

from __future__ import annotations

import re

from sources import text_of


def found(file: str, pattern: str) -> str:
    """The group of the pattern's first match in a file of the project."""
    match = re.search(pattern, text_of(file), re.MULTILINE)
    assert match, f"{file} has no {pattern}"
    return match[1]


def test_versions_are_the_same_in_all_files() -> None:
    version = found("CMakeLists.txt", r"project\(ballpiston VERSION (\S+)")
    assert found("CITATION.cff", r"^version: (\S+)") == version
    assert found("codemeta.json", '"version": "([^"]+)"') == version
    assert found("debian/changelog", r"ballpiston \((\S+)\)") == version
    assert found("CHANGELOG.md", r"^## (\S+),") == version


def test_the_date_and_the_engine_are_the_same_in_all_files() -> None:
    date = found("CHANGELOG.md", r"^## \S+, (\S+),")
    assert found("CITATION.cff", r"^date-released: (\S+)") == date
    assert found("codemeta.json", '"datePublished": "([^"]+)"') == date
    engine = found("core/engine_version.h", r'kEngineVersion\[\] = "([^"]+)"')
    assert found("CHANGELOG.md", r"^## .*, engine (\S+)") == engine
