"""What `ballpiston figure` starts:

    python3 -m ballpiston.figures NAME --out DIR [--quick | --full] [--edit] [--KEYWORD VALUE ...]

Writes the figure's tables, NAME.svg and NAME.png to DIR and prints the paths of the files. With
--edit only copies the figure's module to DIR. A module that lies there is used unchanged.
"""

import importlib
import importlib.util
import inspect
import json
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from typing import Any, NoReturn

import ballpiston
from ballpiston.command import run_program
from ballpiston.figures import names
from ballpiston.figures.parts import style
from ballpiston.figures.parts.tables import Tables
from ballpiston.parameter_lists import INT64, UINT64, number_list, whole_number
from ballpiston.suggestion import did_you_mean
from ballpiston.table import write_table
from ballpiston.whole_file import write_atomically

# What --help says about the keywords of `measure`.
_VARIABLES = {
    "rho": "disc radius",
    "delta": "the piston's penetrations",
    "relaxation_delta": "penetrations at which relaxation times are compared, at most 8",
    "epsilon": "the piston's energies",
    "exponent": "n of the outgoing law h^(n)",
    "cells": "shape of the gas, or lengths of the chains",
    "billiard_cells": "lengths of the billiard's rings",
    "temperature": "temperature of the gas",
    "hot": "temperature of the hot reservoir",
    "cold": "temperature of the cold reservoir",
    "samples": "first hits, or replicas or stretches of a gas, per point",
    "billiard_samples": "replicas or stretches of a gas per point, by the billiard",
    "collisions": "ball-piston collisions per point",
    "seconds": "computing time of the longest run of each method",
    "seed": "seed of the random numbers",
}


class _Parser(ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise ValueError(message)


def main(arguments: list[str]) -> int:
    """Returns the exit code."""
    return run_program(lambda words: _run(*_parsed(words)), arguments)


def _parsed(arguments: list[str]) -> tuple[Namespace, Any]:
    """The options and the figure's module. The options have the keywords of `measure` as they were
    written, or None."""
    name = arguments[0] if arguments else ""
    if name not in names():
        raise ValueError(f"{name!r} is not a figure ({', '.join(names())})")
    parser = _common_flags(name)
    words = [word for word in arguments if word not in ("-h", "--help")]
    options, _ = parser.parse_known_args(words)  # the second parse prints the help
    module = _module(name, None if options.edit else options.out)
    parser.description = module.__doc__
    for keyword, parameter in _variables(module).items():
        text = f"{_VARIABLES[keyword]}; " if keyword in _VARIABLES else ""
        help_text = f"{text}by default {parameter.default}"
        parser.add_argument(_flag(keyword), metavar="VALUE", help=help_text)
    options, unknown = parser.parse_known_args(arguments)
    if unknown:
        hint = did_you_mean(unknown[0], [_flag(keyword) for keyword in _variables(module)])
        raise ValueError(f"{unknown[0]}: the figure {name} has no such variable{hint}")
    if options.out is None:
        raise ValueError("--out is missing: name a folder for data and pictures")
    return options, module


def _common_flags(name: str) -> _Parser:
    """The flags of every figure. The verb figure in client/command/verb_table.cc has them too."""
    parser = _Parser(
        prog="ballpiston figure",
        allow_abbrev=False,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", metavar=name, help="the figure")
    parser.add_argument("--out", type=Path, help="folder for data and pictures; required")
    parser.add_argument("--edit", action="store_true", help="copy the module to it; draw nothing")
    effort = parser.add_mutually_exclusive_group()
    for level, text in [
        ("quick", "few samples"),
        ("full", "the paper's number of samples or more"),
    ]:
        effort.add_argument(
            f"--{level}", dest="effort", action="store_const", const=level, help=text
        )
    return parser


def _variables(module: Any) -> dict[str, inspect.Parameter]:
    parameters = dict(inspect.signature(module.measure, eval_str=True).parameters)
    parameters.pop("client", None)
    return parameters


def _flag(keyword: str) -> str:
    return f"--{keyword.replace('_', '-')}"


def _run(options: Namespace, module: Any) -> list[Path]:
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out: cannot write {options.out}: {error.strerror}") from error
    if options.edit:
        copy = options.out / (installed := _installed(options.name)).name
        if not copy.exists():
            write_atomically(copy, installed.read_bytes())
        return [copy]
    keywords = _keywords(module, options)
    if "client" in inspect.signature(module.measure).parameters:
        with ballpiston.connect() as client:
            data = module.measure(client, **keywords)
    else:
        data = module.measure(**keywords)
    return _written(options, module, data, keywords)


def _installed(name: str) -> Path:
    return Path(__file__).with_name(f"{name.replace('-', '_')}.py")


def _module(name: str, folder: Path | None) -> Any:
    """The one in the folder, if it is there."""
    installed = _installed(name)
    own = (folder or Path()) / installed.name
    if folder is None or not own.exists():
        return importlib.import_module(f"ballpiston.figures.{own.stem}")
    if own.read_bytes() != installed.read_bytes():
        print(
            f"ballpiston: using {own}, which differs from the installed file; delete it to use the "
            "installed file",
            file=sys.stderr,
        )
    found = importlib.util.spec_from_file_location(f"own_{own.stem}", own)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[module.__name__] = module  # dataclasses look it up
    found.loader.exec_module(module)
    return module


def _keywords(module: Any, options: Namespace) -> dict[str, Any]:
    """Those of `measure` that differ from its defaults."""
    keywords: dict[str, Any] = dict(getattr(module, "EFFORT", {}).get(options.effort, {}))
    for keyword, parameter in _variables(module).items():
        if (text := getattr(options, keyword, None)) is not None:
            keywords[keyword] = _value(_flag(keyword), text, parameter.annotation)
    return keywords


def _value(flag: str, text: str, kind: Any) -> Any:
    """The value of a flag. A list of numbers stays a text, which the client reads. A whole number has
    to be at least 1; only the seed may be 0."""
    if kind is bool:
        if text not in ("true", "false"):
            raise ValueError(f"{flag} has to be true or false, not {text!r}")
        return text == "true"
    if kind not in (float, int):
        return text
    # A seed may have more digits than a float.
    is_whole = kind is int and text.isdecimal()
    values: list[float] = [int(text)] if is_whole else number_list(flag, text)
    if len(values) != 1:
        raise ValueError(f"{flag}: {text!r} is not one number")
    bounds = UINT64 if flag == "--seed" else (1, INT64[1])
    return whole_number(flag, values[0], *bounds) if kind is int else values[0]


def _written(
    options: Namespace, module: Any, data: Tables, keywords: dict[str, Any]
) -> list[Path]:
    """The pictures last: where they are, the data are too; and the data stay if `draw` fails."""
    comment = f"ballpiston {ballpiston.__version__}: figure {options.name} {json.dumps(keywords)}"
    paths = []
    for name, table in data.items():
        paths.append(options.out / f"{name}.csv")
        write_table(paths[-1], table, comment)
    figure = module.draw(data)
    for ending in ("png", "svg"):
        paths.append(options.out / f"{options.name}.{ending}")
        style.save(figure, paths[-1])
    return sorted(paths)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
