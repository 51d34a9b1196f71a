#!/usr/bin/python3
"""Builds the site: build_site.py FOLDER writes FOLDER/html.

The sources of Sphinx are staged in FOLDER/source, in the project's own layout, so that links
between pages need no change: README.md as index.md, every page to which a chain of links leads from
there, and files that are downloads. Further pages are made of other sources: the notebooks
(notebook.py), the protos (protocol.py), the headers of the closed forms (equations.py), the names
of the Python package. Sphinx and Doxygen treat warnings as errors, and both check links.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(PROJECT / "client" / "python")]

import equations  # noqa: E402
import html_links  # noqa: E402
import notebook  # noqa: E402
import protocol  # noqa: E402
from build_package import build as build_python_package  # noqa: E402

FOLDERS = ["client", "core", "docs", "proto", "server", "tests", "tools"]
_LINK = re.compile(r"\]\(([^)\s:#]+)((?:#[^)\s]*)?)\)")


class Stage:
    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._staged: set[Path] = set()

    def write(self, name: str, text: str) -> None:
        """A page of the site. Its links are those of a page of the project."""
        path = self._folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        page = PROJECT / name
        path.write_text(_LINK.sub(lambda link: self._linked(page, link), text))

    def add(self, path: Path) -> None:
        """Stages a file or folder of the project, and what it links to."""
        if path in self._staged:
            return
        self._staged.add(path)
        name = str(path.relative_to(PROJECT))
        if path == PROJECT / "README.md":
            self.write("index.md", path.read_text() + (HERE / "contents.md").read_text())
        elif path.is_dir():
            self.write(f"{name}/README.md", _listing(path))
        elif path.suffix == ".ipynb":
            self.write(str(Path(name).with_suffix(".md")), notebook.markdown(path, self._folder))
            shutil.copyfile(path, self._folder / name)
        elif path.suffix == ".proto":
            self.write(str(Path(name).with_suffix(".md")), protocol.markdown(name))
        elif path.suffix == ".md":
            self.write(name, _with_title(path.read_text()) + _pages_below(path))
        else:
            target = self._folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)

    def _linked(self, page: Path, link: re.Match[str]) -> str:
        """The link, to the page that the site has for its target."""
        target = Path(os.path.normpath(page.parent / link[1]))
        if target.is_dir() and (target / "README.md").exists():
            target /= "README.md"
        if target.exists():
            self.add(target)
        if target.is_dir():
            target /= "README.md"
        if target == PROJECT / "README.md":
            target = PROJECT / "index.md"
        if target.suffix in [".ipynb", ".proto"]:
            target = target.with_suffix(".md")
        return f"]({os.path.relpath(target, page.parent)}{link[2]})"


def _with_title(page: str) -> str:
    """A paper has its title in its header, and its headings are of the first level."""
    header = re.match(r"---\n.*?^title: '([^']+)'$.*?^---\n", page, re.DOTALL | re.MULTILINE)
    if not header:
        return page
    return f"# {header[1]}\n\n" + re.sub(r"^#", "##", page[header.end() :], flags=re.MULTILINE)


def _listing(folder: Path) -> str:
    """A page with the files of a folder that has no README."""
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    links = "".join(f"- [{name}]({name})\n" for name in files)
    return f"---\norphan: true\n---\n\n# {folder.name}\n\n{links}"


def _pages_below(page: Path) -> str:
    """A table of contents with the READMEs of the folders below; empty if `page` is no README."""
    if page.name != "README.md":
        return ""
    below = {path for path in page.parent.rglob("*/README.md") if "node_modules" not in path.parts}
    nearest = [path for path in below if not below & {up / path.name for up in path.parents[1:]}]
    names = [f"{path.relative_to(page.parent).with_suffix('')}\n" for path in sorted(nearest)]
    return f"\n```{{toctree}}\n:hidden:\n\n{''.join(names)}```\n" if names else ""


def _python_page(package: Path) -> str:
    """The names that the package exports, the main ones first."""
    sys.path.insert(0, str(package))
    import ballpiston

    first = ["connect", "Client", "specification", "Job", "Result"]
    others = [name for name in ballpiston.__all__ if name not in [*first, "__version__"]]
    lines = ["```{eval-rst}", ".. currentmodule:: ballpiston", ""]
    for name in first + others:
        kind = "autoclass" if isinstance(getattr(ballpiston, name), type) else "autofunction"
        lines += [f".. {kind}:: {name}", *(["   :members:"] if kind == "autoclass" else []), ""]
    return "\n".join([(HERE / "python.md").read_text(), *lines, "```", ""])


def _run(command: list[str | Path], **options: Any) -> None:
    if subprocess.run(command, cwd=PROJECT, **options).returncode != 0:
        raise SystemExit(f"docs: {command[0]} failed or has warnings (above)")


def main(out: Path) -> None:
    shutil.rmtree(out, ignore_errors=True)
    source, package, doxygen = out / "source", out / "python", out / "doxygen"
    doxygen.mkdir(parents=True)
    build_python_package(package)
    settings = (HERE / "Doxyfile").read_text() + f'OUTPUT_DIRECTORY = "{doxygen}"\n'
    _run(["doxygen", "-"], input=settings, text=True)

    stage = Stage(source)
    stage.add(PROJECT / "README.md")
    stage.add(HERE / "cpp.md")
    for folder in FOLDERS:
        for page in sorted((PROJECT / folder).rglob("*.md")):
            if "node_modules" not in page.parts and page.parent != HERE:
                stage.add(page)
    stage.write("docs/site/python.md", _python_page(package))
    stage.write("docs/site/equations.md", equations.markdown())
    stage.write("docs/site/protocol.md", protocol.contents())
    for proto in protocol.FILES:
        stage.add(PROJECT / proto)
    for name in ["conf.py", "style.css"]:
        shutil.copyfile(HERE / name, source / name)
    _run(
        ["sphinx-build", "-W", "--keep-going", "-q", "-d", out / "doctrees", source, out / "html"],
        env={**os.environ, "PYTHONPATH": str(package)},
    )
    count, dead = html_links.check(out / "html")
    if dead:
        raise SystemExit("\n".join(["docs: links that lead nowhere:", *dead]))
    print(f"{out}/html/index.html: {count} links inside the site, all lead somewhere")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
