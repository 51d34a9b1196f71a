"""The package as a whole: the order of its modules, its types, and its installation by pip."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

from conftest import PROJECT

import ballpiston

SOURCES = PROJECT / "client" / "python"


def imports_of(module: Path) -> set[str]:
    """The modules of this package that a module names, also inside functions and for types only."""
    nodes = list(ast.walk(ast.parse(module.read_text())))
    names = {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
    names |= {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return {name for name in names if name.startswith("ballpiston.")}


def test_modules_import_each_other_in_one_direction() -> None:
    package = SOURCES / "ballpiston"
    graph = {
        ".".join(path.relative_to(SOURCES).with_suffix("").parts): imports_of(path)
        for path in package.rglob("*.py")
        if path.name != "__init__.py"
    }
    assert "ballpiston.job" in graph
    TopologicalSorter(graph).prepare()  # raises CycleError


def test_pip_installs_the_package(tmp_path: Path) -> None:
    """Into a virtual environment that sees the system's NumPy and grpcio, without a network."""
    for part in ["client/python", "proto", "CMakeLists.txt"]:  # pip leaves files where it builds
        copy = shutil.copytree if (PROJECT / part).is_dir() else shutil.copy
        (tmp_path / part).parent.mkdir(exist_ok=True)
        copy(PROJECT / part, tmp_path / part)
    environment = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", environment], check=True)
    python = environment / "bin" / "python"
    install = [python, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*install, tmp_path / "client" / "python"], check=True)
    program = "import ballpiston; print(ballpiston.__file__, ballpiston.__version__)"
    run = subprocess.run([python, "-c", program], env={}, stdout=subprocess.PIPE, check=True)
    place, version = run.stdout.decode().split()
    assert Path(place).is_relative_to(environment)
    assert version == ballpiston.__version__


def test_the_types_are_complete() -> None:
    config = SOURCES / "pyproject.toml"
    package = Path(ballpiston.__file__).parent
    mypy = [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir=/dev/null"]
    run = subprocess.run([*mypy, package], stdout=subprocess.PIPE, text=True)
    assert run.returncode == 0, run.stdout
