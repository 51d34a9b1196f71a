"""The project's Markdown pages and notebooks: their links, headings and commands."""

from __future__ import annotations

import json
import re
import shlex
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from conftest import PROJECT

FOLDERS = ["client", "core", "docs", "proto", "server", "tests", "tools"]


def pages() -> list[Path]:
    """README.md and its neighbours, docs/, the READMEs of the folders, and the notebooks."""
    found = list(PROJECT.glob("*.md"))
    for folder in FOLDERS:
        found += (PROJECT / folder).rglob("*.md")
        found += (PROJECT / folder).rglob("*.ipynb")
    return sorted(path for path in found if "node_modules" not in path.parts)


def text_of(page: Path) -> str:
    """The page's Markdown; of a notebook that of its cells of text."""
    text = page.read_text()
    if page.suffix != ".ipynb":
        return text
    cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "markdown"]
    return "\n\n".join("".join(cell["source"]) for cell in cells)


_BLOCK = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)


def prose_of(text: str) -> str:
    """Without blocks of code."""
    return _BLOCK.sub("", text)


def code_in_lines(text: str) -> list[str]:
    """The texts in backquotes."""
    return [code.replace("\n", " ") for code in re.findall(r"`([^`]+)`", prose_of(text))]


def links(text: str) -> list[str]:
    """The targets of relative links and pictures."""
    found = re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", prose_of(text)))
    return [target for target in found if "://" not in target]


def anchors(text: str) -> set[str]:
    """The anchors of the headings, as GitHub and Sphinx make them."""
    found: set[str] = set()
    seen: Counter[str] = Counter()
    for heading in re.findall(r"^#+ (.+)$", prose_of(text), re.MULTILINE):
        shown = re.sub(r"\]\([^)]*\)", "", heading)
        slug = re.sub(r"[^\w\- ]", "", shown.lower()).replace(" ", "-")
        found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
        seen[slug] += 1
    return found


class Command(NamedTuple):
    """A call of the program `ballpiston` in a block of code."""

    page: str
    words: list[str]  # without the program's name
    shown: str  # what the page shows as its output

    def __str__(self) -> str:
        return f"{self.page}: ballpiston {shlex.join(self.words)}"


def commands(page: Path) -> list[Command]:
    """Blocks with a language, such as Python, are not shell, and neither are indented lines. In a
    block with prompts the other lines are output."""
    found = []
    for indent, language, block in _BLOCK.findall(text_of(page)):
        if language:
            continue
        block = re.sub(f"^{indent}", "", block, flags=re.MULTILINE)
        lines = re.sub(r"\\\n|\|\n", lambda end: end[0][0].strip("\\") + " ", block)
        if re.search(r"^\$ ", lines, re.MULTILINE):
            prompts = re.split(r"^\$ ", lines, flags=re.MULTILINE)[1:]
            scripts = [prompt.partition("\n")[::2] for prompt in prompts]
        else:
            scripts = [(line, "") for line in lines.splitlines() if not line.startswith(" ")]
        name = str(page.relative_to(PROJECT))
        for script, shown in scripts:
            found += [Command(name, words, shown) for words in calls(script)]
    return found


_CALL = re.compile(r"""(?:^|[;&|(]) *ballpiston ((?:[^'"();<>|&]|'[^']*'|"[^"]*")*)""")


def calls(script: str) -> list[list[str]]:
    """The words of each call of `ballpiston`, without the program's name. A call begins a line or
    follows ; & | or (; it ends at a parenthesis, ; & | < or > outside of quotes."""
    return [shlex.split(words, comments=True) for words in _CALL.findall(script)]
