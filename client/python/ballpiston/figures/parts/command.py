"""ballpiston figure NAME --out DIR [--quick | --full] [--edit] [--KEYWORD VALUE ...]

Writes the figure's tables, NAME.svg and NAME.png to DIR and prints the paths of the files. With
--edit only copies the figure's module to DIR. A module that lies there is used unchanged.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import json
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from types import ModuleType
from typing import Any

import ballpiston
from ballpiston.document import write_atomically
from ballpiston.figures import names
from ballpiston.figures.parts import style, tables
from ballpiston.parameter_lists import number_list, whole_number
from ballpiston.program import run_program

def main(arguments: list[str]) -> int:
    """Returns the exit code."""
    return run_program(lambda words: _run(_parsed(words)), arguments)


def _parsed(arguments: list[str]) -> tuple[Namespace, dict[str, str]]:
    """The options, and the keywords of `measure` as they were written."""
    parser = ArgumentParser(prog="ballpiston figure", allow_abbrev=False)
    parser.add_argument("name", choices=names())
    parser.add_argument("--out", required=True, type=Path)
    parser.add_argument("--quick", dest="effort", action="store_const", const="quick")
    parser.add_argument("--full", dest="effort", action="store_const", const="full")
    parser.add_argument("--edit", action="store_true")
    options, rest = parser.parse_known_args(arguments)
    if len(rest) % 2 or not all(flag.startswith("--") for flag in rest[::2]):
        parser.error(f"these are not pairs of a flag and a value: {' '.join(rest)}")
    flags = [flag.removeprefix("--").replace("-", "_") for flag in rest[::2]]
    return options, dict(zip(flags, rest[1::2]))


def _run(parsed: tuple[Namespace, dict[str, str]]) -> list[Path]:
    options, texts = parsed
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out: cannot write {options.out}: {error.strerror}") from error
    own = options.out / f"{options.name.replace('-', '_')}.py"
    if options.edit:
        return [_copied(options.name, own)]
    module = _module(options.name, own)
    keywords = _keywords(module, options.name, options.effort, texts)
    if "client" in inspect.signature(module.measure).parameters:
        with ballpiston.connect() as client:
            data = module.measure(client, **keywords)
    else:
        data = module.measure(**keywords)
    return _written(options, data, module.draw(data), keywords)


def _copied(name: str, to: Path) -> Path:
    if not to.exists():
        write_atomically(to, Path(_installed(name)).read_bytes())
    return to


def _installed(name: str) -> str:
    return str(Path(__file__).parents[1] / f"{name.replace('-', '_')}.py")


def _module(name: str, own: Path) -> ModuleType:
    if not own.exists():
        return importlib.import_module(f"ballpiston.figures.{own.stem}")
    if own.read_bytes() != Path(_installed(name)).read_bytes():
        print(
            f"ballpiston: using {own}, which differs from the installed file; delete it to use the "
            "installed file",
            file=sys.stderr,
        )
    found = importlib.util.spec_from_file_location(own.stem, own)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def _keywords(
    module: ModuleType, name: str, effort: str | None, texts: dict[str, str]
) -> dict[str, Any]:
    """Those of `measure` that differ from its defaults."""
    keywords: dict[str, Any] = dict(module.EFFORT.get(effort, {})) if effort else {}
    parameters = inspect.signature(module.measure).parameters
    for keyword, text in texts.items():
        flag = f"--{keyword.replace('_', '-')}"
        if keyword not in parameters:
            raise ValueError(f"{flag}: the figure {name} has no such variable")
        keywords[keyword] = _value(flag, text, str(parameters[keyword].annotation))
    return keywords


def _value(flag: str, text: str, kind: str) -> Any:
    """A list of numbers stays as it was written; the client reads it."""
    if kind == "int" and text.isdecimal():
        return int(text)  # a seed may have more digits than a float
    if kind not in ("float", "int"):
        return text
    values = number_list(flag, text)
    if len(values) != 1:
        raise ValueError(f"{flag}: {text!r} is not one number")
    return whole_number(flag, values[0]) if kind == "int" else values[0]


def _written(
    options: Namespace, data: tables.Tables, figure: Any, keywords: dict[str, Any]
) -> list[Path]:
    """The pictures last: where they are, the data are too."""
    comment = f"ballpiston {ballpiston.__version__}: figure {options.name} {json.dumps(keywords)}"
    paths = []
    for name, table in data.items():
        paths.append(options.out / f"{name}.csv")
        tables.write(paths[-1], table, comment)
    for ending in ("png", "svg"):
        paths.append(options.out / f"{options.name}.{ending}")
        style.save(figure, paths[-1])
    return sorted(paths)
