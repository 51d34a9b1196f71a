"""Comments of the project's C++ and protos, as text for the site.

Doxygen runs this file as a program for each header. The program prints the header, and changes its
ordinary comments to the kind of comments that Doxygen reads.
"""

import itertools
import re
import sys
import textwrap
from pathlib import Path

_SPECIAL = re.compile(r"([\\@<>#%&$~])")


def opening(path: Path) -> list[str]:
    """The lines of the comment with which a file begins, without `//`."""
    lines = path.read_text().splitlines()
    return [line[3:] for line in itertools.takewhile(lambda line: line.startswith("//"), lines)]


def blocks(lines: list[str]) -> list[tuple[bool, list[str]]]:
    """Runs of lines of text (false) and of indented lines (true), which keep their layout but lose
    the indent that they share. An empty line ends a run of text."""
    found: list[tuple[bool, list[str]]] = []
    for line in lines:
        is_code = line.startswith("  ") or (not line and bool(found) and found[-1][0])
        if not line and not is_code:
            found.append((False, []))
        elif found and found[-1][0] == is_code:
            found[-1][1].append(line)
        else:
            found.append((is_code, [line]))
    texts = [(is_code, textwrap.dedent("\n".join(run)).rstrip()) for is_code, run in found]
    return [(is_code, text.split("\n")) for is_code, text in texts if text]


def markdown(lines: list[str]) -> str:
    parts = []
    for is_code, run in blocks(lines):
        text = "\n".join(run)
        parts.append(f"```\n{text}\n```" if is_code else escaped(text))
    return "\n\n".join(parts)


def escaped(text: str) -> str:
    """Markdown that shows the text; code in backquotes stays code."""
    parts = re.split(r"(`[^`]*`)", text)
    parts[::2] = [re.sub(r"([\\*_\[\]<>|#$~])", r"\\\1", part) for part in parts[::2]]
    return "".join(parts)


def for_doxygen(lines: list[str]) -> list[str]:
    """The lines of one comment, for what follows it."""
    out = ["/**"]
    for is_code, run in blocks(lines):
        if is_code:
            out += ["@verbatim", *run, "@endverbatim"]
        else:
            out += [*(_SPECIAL.sub(r"\\\1", line) for line in run), ""]
    return [*out, "*/"]


def filtered(text: str) -> str:
    """Without the namespace: each header would declare it once more, which Sphinx rejects."""
    out: list[str] = []
    lines = re.sub(r"^(?:namespace .*\{|\}  // namespace .*)$", "", text, flags=re.M).splitlines()
    for is_comment, run in itertools.groupby(lines, lambda line: line.lstrip().startswith("//")):
        if is_comment:
            comment = for_doxygen([line.strip()[3:] for line in run])
            out += comment if out else [comment[0], "@file", *comment[1:]]
        else:
            # A comment behind a declaration.
            out += [re.sub(r"([;,{])  // (.*)", _behind, line) for line in run]
    return "\n".join(out) + "\n"


def _behind(found: re.Match[str]) -> str:
    return found[1] + "  ///< " + _SPECIAL.sub(r"\\\1", found[2])


if __name__ == "__main__":
    sys.stdout.write(filtered(Path(sys.argv[1]).read_text()))
