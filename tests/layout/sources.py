"""The files of the project."""

from __future__ import annotations

from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
FOLDERS = ["client", "core", "proto", "server", "tests", "tools"]


def text_of(path: str) -> str:
    return (PROJECT / path).read_text(encoding="utf-8")


def files(folders: list[str], *endings: str) -> dict[str, str]:
    """The text of each file in these folders whose name has one of these endings, by its path in
    the project."""
    found = (path for folder in folders for path in (PROJECT / folder).rglob("*"))
    paths = (str(path.relative_to(PROJECT)) for path in found if path.suffix in endings)
    return {path: text_of(path) for path in sorted(paths)}


SOURCES = files(FOLDERS, ".h", ".cc")  # the C++ files
