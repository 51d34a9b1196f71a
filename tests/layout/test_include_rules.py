"""Files include only what the rules of their folder permit (include_rules.txt)."""

from __future__ import annotations

import re
from typing import NamedTuple

import pytest
from sources import FOLDERS, PROJECT, SOURCES, text_of


class Rule(NamedTuple):
    folder: str
    may_include: tuple[str, ...]  # prefixes
    operating_system: bool


def read_rules(text: str) -> list[Rule]:
    """A row begins with a folder and a colon; the words after it, on this line and the next ones,
    are what it may include."""
    rows = re.split(r"^(\S+):", re.sub(r"^#.*\n", "", text, flags=re.MULTILINE), flags=re.MULTILINE)
    return [
        Rule(folder, (folder, *(set(words.split()) - {"system"})), "system" in words.split())
        for folder, words in zip(rows[1::2], rows[2::2])
    ]


RULES = read_rules(text_of("tests/layout/include_rules.txt"))
THREADS_AND_CLOCKS = ("thread", "future", "mutex", "condition_variable", "chrono", "ctime",
                      "absl/synchronization/", "absl/time/")  # fmt: skip


def is_allowed(rule: Rule, include: str) -> bool:
    if include.startswith(THREADS_AND_CLOCKS) and not rule.operating_system:
        return False
    is_standard = not re.search("[/.]", include)  # <vector>, <cmath>, ...
    is_of_system = include.startswith(("sys/", "arpa/", "netinet/")) or "/" not in include
    return (
        is_standard
        or include.startswith(rule.may_include)
        or (rule.operating_system and is_of_system and include != "sqlite3.h")
    )


def includes_of(text: str) -> list[str]:
    """The included files, in order, without quotes or angle brackets."""
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]*)[>"]', text, re.MULTILINE)


def wrong_includes(path: str, text: str) -> list[str]:
    """One sentence for each include that is not permitted."""
    rule = next((rule for rule in RULES if path.startswith(rule.folder)), None)
    if not rule:
        return [f"{path} lies in a folder without a rule"]
    includes = includes_of(text)
    wrong = [f"{path} may not include {name}" for name in includes if not is_allowed(rule, name)]
    # The core's physics and the API's messages meet in server/convert only.
    both = [any(name.startswith(part) for name in includes) for part in ("core/", "ballpiston/v1/")]
    if all(both) and re.match(r"server/(?!convert/)", path):
        wrong.append(f"{path} includes core/ and ballpiston/v1/; only server/convert/ may")
    return wrong


def test_every_include_is_allowed() -> None:
    wrong = [sentence for file in SOURCES.items() for sentence in wrong_includes(*file)]
    assert not wrong, "\n".join(wrong)


def test_sources_of_all_folders_are_read() -> None:
    read = {"core/geometry/pair_geometry.h", "tests/support/paths.cc", "tools/stability/main.cc"}
    assert read <= SOURCES.keys()
    text = SOURCES["core/geometry/pair_geometry.cc"]
    assert "core/geometry/pair_geometry.h" in includes_of(text)


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_top_folder_has_a_readme(folder: str) -> None:
    assert (PROJECT / folder / "README.md").exists()


# ---- The rules can fail ----


def including(files: str) -> str:
    return "".join(f"#include <{file}>\n" for file in files.split())


# The rules of a folder are in include_rules.txt. Here is one row for each way to break one.
FORBIDDEN = [
    ("core/geometry/x.h", "core/sampling/direction.h Random123/philox.h"),  # another layer
    ("core/experiment/x.cc", "thread mutex chrono ctime time.h absl/time/clock.h unistd.h"),
    ("server/compute/x.cc", "server/cluster/folder_executor.h server/book/job.h ballpiston/v1/a.h"),
    ("server/worker/x.cc", "server/convert/spec.h server/compute/scheduler.h grpcpp/grpcpp.h"),
    ("server/book/x.cc", "sqlite3.h client/library/client.h tests/support/paths.h"),
    ("server/command_line/x.cc", "core/ensemble/chunk_plan.h"),  # the row of the inner folder
    ("client/command/x.cc", "sqlite3.h core/geometry/pair_geometry.h server/convert/spec.h"),
    ("tools/stability/x.cc", "grpcpp/grpcpp.h ballpiston/v1/result.pb.h gtest/gtest.h"),
    ("tests/core/geometry/x.cc", "server/store/store.h tests/server/running_server.h"),
    ("tests/support/x.cc", "core/geometry/pair_geometry.h grpcpp/channel.h"),
]


@pytest.mark.parametrize("path, includes", FORBIDDEN, ids=[path for path, _ in FORBIDDEN])
def test_other_layers_threads_and_clocks_are_forbidden(path: str, includes: str) -> None:
    files = includes.split()
    assert not [file for file in files if len(wrong_includes(path, including(file))) != 1]


def test_physics_and_messages_meet_in_convert_only() -> None:
    both = including("core/ensemble/ensemble_spec.h ballpiston/v1/spec.pb.h")
    assert len(wrong_includes("server/book/x.cc", both)) == 1
    assert wrong_includes("server/convert/x.cc", both) == []


def test_a_folder_without_a_rule_is_an_error() -> None:
    assert len(wrong_includes("core/thermostat/x.cc", "")) == 1
