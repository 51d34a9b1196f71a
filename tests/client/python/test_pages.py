"""The project's Markdown pages and notebooks: links lead somewhere, and commands are right."""

from __future__ import annotations

import functools
import importlib
import inspect
import json
import re
import shlex
import subprocess
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import pytest
from conftest import PROJECT, Home

from ballpiston import figures

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


PAGES = pages()
# The reference is made from the table of verbs and flags, and other tests check it.
COMMANDS = [
    command for page in PAGES if page.name != "command-line.md" for command in commands(page)
]
# Seconds of a processor: questions for which `plan` predicts less are asked. Those whose answer the
# page shows may take longer.
QUICK, QUICK_IF_SHOWN = 0.2, 2.0


def dead_links(page: Path, text: str) -> list[str]:
    """The relative links of the text that lead nowhere. `page` is the file that it is in."""
    dead = []
    for link in links(text):
        target, _, anchor = link.partition("#")
        path = (page.parent / target).resolve() if target else page
        if not path.exists():
            dead.append(link)
        elif anchor and anchor not in anchors(text if path == page else text_of(path)):
            dead.append(link)
    return dead


def missing_files(page: Path, text: str) -> list[str]:
    """The paths of files and folders in backquotes that do not exist, neither in the project nor in
    the page's folder. Patterns and placeholders in capitals are no paths."""
    named = re.compile(rf"(?:{'|'.join(FOLDERS)}|scripts)/[a-z0-9_./-]+")
    paths = [code for code in code_in_lines(text) if named.fullmatch(code)]
    folders = [PROJECT, page.parent]
    sources = [code for code in code_in_lines(text) if _SOURCE.fullmatch(code)]
    return [path for path in paths if not any((folder / path).exists() for folder in folders)] + [
        name for name in sources if name not in source_names()
    ]


_SOURCE = re.compile(r"[a-z0-9_]+(?:-inl)?\.(?:h|cc|proto)")


@functools.cache
def source_names() -> set[str]:
    """The names of all headers, sources and protos, which pages may name without their folder."""
    files = (file for folder in FOLDERS for file in (PROJECT / folder).rglob("*"))
    return {file.name for file in files if _SOURCE.fullmatch(file.name)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(PROJECT)))
def test_every_link_leads_to_a_heading_and_every_path_to_a_file(page: Path) -> None:
    text = text_of(page)
    assert (dead_links(page, text), missing_files(page, text)) == ([], [])


@functools.cache
def flags_of_verbs(home: Home) -> dict[str, set[str]]:
    """Those without a verb have the empty key."""
    reference = home.command("help", "--format", "markdown")
    verbs = re.findall(r"^## ballpiston (.+)$", reference, re.MULTILINE) + [""]
    flag = re.compile(r"(?<![\w-])--?[a-z][\w-]*")
    return {verb: set(flag.findall(home.command("help", "--all", *verb.split()))) for verb in verbs}


def unknown_word(home: Home, words: list[str]) -> str | None:
    """The first word that is no verb, or no flag of the verb."""
    table = flags_of_verbs(home)
    verb = next(verb for verb in table if words[: len(verb.split())] == verb.split())
    if not verb and not words[0].startswith("-"):
        return words[0]
    own = words[: words.index("--")] if "--" in words else words  # the rest is for ballpistond
    given = [word.partition("=")[0] for word in own if re.match(r"--?[a-z]", word)]
    known = set(table[verb]) | (flags_of_figure(words[1]) if verb == "figure" else set())
    return next((flag for flag in given if flag not in known), None)


def flags_of_figure(name: str) -> set[str]:
    """The variables of a figure, which the package knows; help has the other flags."""
    if name not in figures.names():
        return set()
    module = importlib.import_module(f"ballpiston.figures.{name.replace('-', '_')}")
    keywords = inspect.signature(module.measure).parameters
    return {f"--{keyword.replace('_', '-')}" for keyword in keywords}


@pytest.mark.parametrize("command", COMMANDS, ids=str)
def test_every_command_has_a_verb_and_flags_of_the_program(home: Home, command: Command) -> None:
    assert unknown_word(home, command.words) is None


def test_commands_in_sentences_have_verbs_and_flags_of_the_program(home: Home) -> None:
    for page in PAGES:
        for code in code_in_lines(text_of(page)):
            for words in calls(code) if code.startswith("ballpiston ") else []:
                assert unknown_word(home, words) is None, f"{page}: {code}"


# Questions that are whole in the command line.
QUESTIONS = [
    command
    for command in COMMANDS
    if command.words[0] in ["analytic", "plan", "run", "submit", "trace"]
    and not {"--spec", "--points", "--save"} & set(command.words)
]


def is_quick(home: Home, command: Command) -> bool:
    verb, *rest = command.words
    if verb == "run":
        if "--format" in rest:
            place = rest.index("--format")
            del rest[place : place + 2]
        limit = QUICK_IF_SHOWN if command.shown else QUICK
        return bool(json.loads(home.command("plan", *rest, "--format", "json"))["work"] < limit)
    if verb == "trace":
        return int(rest[rest.index("--events") + 1]) <= 1000
    return verb in ["analytic", "plan"]


def numbers(text: str) -> set[str]:
    return set(re.findall(r"(?<![\w.])[+-]?\d+\.\d+(?![\w.])", text))


@pytest.mark.parametrize("command", QUESTIONS, ids=str)
def test_quick_questions_have_the_shown_answer_and_others_are_accepted(
    home: Home, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick = is_quick(home, command)
    if not quick:
        monkeypatch.setenv("BALLPISTON_SERVER", "unix:/none/socket")
    done = home.run(*command.words, stdin=subprocess.DEVNULL)
    # Without a server: the words are right, and no server answers.
    assert done.returncode == (0 if quick else 3), done.stderr
    if quick and command.words[0] != "plan":  # which predicts times
        assert numbers(command.shown) <= numbers(done.stdout)


# Tests of the tests.
def test_planted_errors_are_found(home: Home) -> None:
    page = PROJECT / "docs" / "README.md"
    text = "# Words\n[a](limits.md) [b](#words) [c](none.md) [d](limits.md#none) [e](#none)"
    assert dead_links(page, text) == ["none.md", "limits.md#none", "#none"]
    assert missing_files(page, "`core/README.md` and `core/none.md`") == ["core/none.md"]
    assert unknown_word(home, ["run", "first-hit", "--rho", "0.53"]) is None
    assert unknown_word(home, ["run", "first-hit", "--radius", "0.53"]) == "--radius"
    assert unknown_word(home, ["ran", "first-hit"]) == "ran"
    assert unknown_word(home, ["figure", "cell", "--delta", "0.1"]) is None
    assert unknown_word(home, ["figure", "cell", "--epsilon", "0.1"]) == "--epsilon"
