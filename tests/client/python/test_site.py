"""The pages that the site makes of other sources. `make docs` makes the whole site."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from conftest import PROJECT

sys.path.append(str(PROJECT / "docs" / "site"))

import comments
import equations
import html_links
import notebook
import protocol


def test_the_page_of_equations_has_every_label_and_links_to_files() -> None:
    page = equations.markdown()
    labels = (PROJECT / "tests" / "data" / "equation_labels.txt").read_text().split()
    assert re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE) == labels
    links = re.findall(r"\]\(\.\./\.\./([^)]+)\)", page)
    assert links and all((PROJECT / link).exists() for link in links)


@pytest.mark.parametrize("name", protocol.FILES)
def test_the_page_of_a_proto_has_its_calls_messages_and_fields(name: str) -> None:
    page, source = protocol.markdown(name), (PROJECT / name).read_text()
    for word in re.findall(r"^ *(?:message|enum|service|rpc) (\w+)", source, re.MULTILINE):
        assert re.search(rf"^###? (?:\w+\.)*{word}$", page, re.MULTILINE), word
    for word in re.findall(r"^ *[\w.<>, ]+ (\w+) = \d+;", source, re.MULTILINE):
        assert f"| `{word}` |" in page


def test_the_contents_have_every_page_of_docs() -> None:
    contents = (PROJECT / "docs" / "site" / "contents.md").read_text().split()
    for page in [*PROJECT.glob("docs/*.md"), *PROJECT.glob("docs/research/*.md")]:
        assert str(page.relative_to(PROJECT).with_suffix("")) in contents


def test_a_notebook_becomes_text_code_output_and_pictures(tmp_path: Path) -> None:
    path = PROJECT / "client" / "examples" / "python" / "two_reservoirs.ipynb"
    page = notebook.markdown(path, tmp_path)
    assert page.startswith("# A gas between two reservoirs\n") and "```python\nimport" in page
    assert "conductivity ratio: 1.003 ± 0.012" in page
    (picture,) = re.findall(r"!\[Figure\]\((\S+)\)", page)
    assert (tmp_path / path.parent.relative_to(PROJECT) / picture).read_bytes()[1:4] == b"PNG"


def test_comments_become_text_and_code() -> None:
    lines = ["The volume |G| of", "a_b.", "", "  x = 1", "    y", "after `a|b`"]
    assert comments.markdown(lines) == (
        "The volume \\|G\\| of\na\\_b.\n\n```\nx = 1\n  y\n```\n\nafter `a|b`"
    )
    assert comments.filtered("// A file.\n#pragma once\nint a;  // <one>\n") == (
        "/**\n@file\nA file.\n\n*/\n#pragma once\nint a;  ///< \\<one\\>\n"
    )


def test_links_of_the_site_that_lead_nowhere_are_found(tmp_path: Path) -> None:
    links = ["a.html", "a.html#here", "#here", "https://example.org/x", "none.html", "a.html#none"]
    text = "<p id='here'>" + "".join(f"<a href='{link}'></a>" for link in links)
    (tmp_path / "a.html").write_text(text)
    assert html_links.check(tmp_path) == (5, ["a.html: a.html#none", "a.html: none.html"])
