"""A number that several pages state is equal on all of them, and in docs/numbers.md. A page marks
such a number with its name: 21<!--gain-rare-avx2-->. The files that name the version of the
project, its date or the engine's version agree, too. So do `make` and what is installed, and the
alert rules and the server's metrics."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sources import FOLDERS, files, text_of

NUMBERS = "docs/numbers.md"


def numbers_in(page: str) -> dict[str, str]:
    """Number by name, from the rows | `name` | number | ... | of the page."""
    return dict(re.findall(r"^\| `([a-z0-9-]+)` \| ([^|\n]+) \|", page, re.MULTILINE))


def marked_numbers(page: str) -> Iterator[tuple[str, str]]:
    """The name of each mark, and the text of the line before it."""
    for mark in re.finditer(r"<!--([a-z0-9-]+)-->", page):
        yield mark[1], page[: mark.start()].rpartition("\n")[2]


def ends_with(line: str, number: str) -> bool:
    """Whether the number is the end of the line, and a whole word."""
    return re.search(rf"(?:^|\s){re.escape(number)}$", line) is not None


def test_shared_numbers_are_the_same_on_all_pages() -> None:
    numbers, used = numbers_in(text_of(NUMBERS)), set()
    pages = {"README.md": text_of("README.md")} | files([*FOLDERS, "docs"], ".md")
    for path, page in pages.items():
        for name, line in marked_numbers(page) if path != NUMBERS else []:
            assert name in numbers, f"{path}: {name} is not in {NUMBERS}"
            number = numbers[name]
            assert ends_with(line, number), f"{path}: {name} is {number}, but the page says: {line}"
            used.add(name)
    assert numbers.keys() - used == set(), "on no page"


# A test of the tests.
def test_numbers_are_whole_words() -> None:
    (name, first), (_, second) = marked_numbers("it takes 12<!--a--> s, or\n112<!--a--> s")
    assert name == "a"
    assert ends_with(first, "12") and not ends_with(first, "13")
    assert not ends_with(second, "12")


# Versions


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


def test_make_builds_all_programs_and_pages_that_are_installed() -> None:
    lists = "".join([text_of("CMakeLists.txt"), *files(FOLDERS, ".txt").values()])
    installed = re.findall(r"(?:install\(TARGETS|custom_target\()([\w -]+) (?:RUNTIME|ALL)", lists)
    built = found("Makefile", "^PROGRAMS := (.*)").split()
    assert {"ballpiston-worker", "pages"} <= set(" ".join(installed).split()) <= set(built)


def test_alert_rules_name_metrics_of_the_server() -> None:
    """Those in quotes in the server's code. `make test-alerts` tests the rules."""
    metric = r"\b(?:ballpiston|grpc_server)_\w+"
    named = set(re.findall(metric, text_of("server/prometheus/alerts.yml")))
    code = text_of("server/rpc/server_metrics.cc") + text_of("server/status/call_observer.cc")
    assert {"ballpiston_store_failing"} <= named <= set(re.findall(f'"({metric})"', code))
