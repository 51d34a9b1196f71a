"""The page of the paper's equations: which file computes each, and the derivations."""

from __future__ import annotations

import re
from pathlib import Path

import comments

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]
FORMS = PROJECT / "core" / "closed_form"


def citations() -> dict[str, list[Path]]:
    """By label, the sources whose opening comment cites the equation, as `eq. LABEL`. Other words
    than labels do no harm."""
    found: dict[str, list[Path]] = {}
    for path in sorted([*PROJECT.glob("core/**/*.h"), *PROJECT.glob("core/**/*.cc")]):
        text = " ".join(comments.opening(path))
        for labels in re.findall(r"\beqs?\. (\w+(?:, \w+)*(?: and \w+)?)", text):
            for label in re.findall(r"\w+", labels):
                found.setdefault(label, []).append(path.relative_to(PROJECT))
    return found


def table() -> list[str]:
    """The rows of the table in core/closed_form/README.md, with the sources that cite the label."""
    text = (FORMS / "README.md").read_text()
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \|$", text.split("equations:begin")[1], re.M)
    cited = citations()
    lines = ["| equation | what it is | where |", "|---|---|---|"]
    for label, what, where in rows:
        files = [path for path in dict.fromkeys(cited.get(label, [])) if path.name not in where]
        named = "".join(f"; cited in [{path.name}](../../{path})" for path in files)
        lines.append(f"| `{label}` | {what} | {where}{named} |")
    return lines


def derivations() -> list[str]:
    """The opening comments of the closed forms, in the README's reading order."""
    order = re.findall(r"`(\w+)\.h`", (FORMS / "README.md").read_text())
    lines = []
    for stem in dict.fromkeys(order):
        files = [FORMS / f"{stem}{end}" for end in [".h", ".cc"]]
        texts = [comments.opening(file) for file in files if file.exists()]
        if any(texts):
            lines += [f"### {stem}", ""]
        for text in filter(None, texts):
            lines += [comments.markdown(text), ""]
    return lines


def markdown() -> str:
    before, after = (HERE / "equations.md").read_text().split("## The closed forms")
    return "\n".join([before, *table(), "", "## The closed forms", after, *derivations()])
