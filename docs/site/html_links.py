"""Links of the finished site: each leads to a file, and to an element with the link's anchor."""

from __future__ import annotations

import functools
import os
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Page(HTMLParser):
    def __init__(self, path: Path) -> None:
        super().__init__()
        self.targets: set[str] = set()
        self.ids = {""}
        self.feed(path.read_text())

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name in ["href", "src"] and value:
                self.targets.add(value)
            if name in ["id", "name"] and value:
                self.ids.add(value)


_page = functools.cache(_Page)


def check(folder: Path) -> tuple[int, list[str]]:
    """The number of links inside the site, and those that lead nowhere."""
    count, dead = 0, []
    for path in sorted(folder.rglob("*.html")):
        for target in sorted(_page(path).targets):
            link = urlsplit(target)
            if link.scheme or link.netloc:
                continue
            count += 1
            to = Path(os.path.normpath(path.parent / unquote(link.path))) if link.path else path
            is_page = to.suffix == ".html"
            if not to.exists() or is_page and unquote(link.fragment) not in _page(to).ids:
                dead.append(f"{path.relative_to(folder)}: {target}")
    return count, dead
