"""The package as a whole: the order of its modules, its types, its installation by pip, and its
generated modules beside those of other packages."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from conftest import LIMIT, PROJECT, Home

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
    prefix = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", prefix], check=True)
    python = prefix / "bin" / "python"
    install = [python, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*install, tmp_path / "client" / "python"], check=True)
    program = "import ballpiston; print(ballpiston.__file__, ballpiston.__version__)"
    run = subprocess.run([python, "-c", program], env={}, stdout=subprocess.PIPE, check=True)
    place, version = run.stdout.decode().rsplit(maxsplit=1)
    assert Path(place).is_relative_to(prefix)
    assert version == ballpiston.__version__


def test_the_types_are_complete() -> None:
    config = SOURCES / "pyproject.toml"
    package = Path(ballpiston.__file__).parent
    mypy = [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir=/dev/null"]
    run = subprocess.run([*mypy, package], stdout=subprocess.PIPE, text=True)
    assert run.returncode == 0, run.stdout


# Generated modules


def test_the_package_has_its_own_copy_of_google_rpc(home: Home) -> None:
    """Without googleapis-common-protos nothing is put into the package google."""
    program = (
        "import sys\n"
        "sys.modules['google.rpc'] = None\n"
        "import ballpiston\n"
        "from ballpiston._google_rpc import status_pb2\n"
        "print(status_pb2.__name__, 'google.rpc.status_pb2' in sys.modules)"
    )
    printed = "ballpiston._google_rpc.status_pb2 False\n"
    assert home.python(program).communicate(timeout=LIMIT) == (printed, "")


@pytest.mark.skipif(shutil.which("protoc") is None, reason="protoc is not installed")
@pytest.mark.parametrize("first", ["ballpiston", "google.rpc.status_pb2"])
@pytest.mark.parametrize("package", ["x", r"\1"], ids=["other options", "same options"])
def test_installed_modules_of_google_rpc_are_used(
    first: str, package: str, home: Home, tmp_path: Path
) -> None:
    """googleapis-common-protos has the same files with other options, which the pool of descriptors
    rejects beside ours. Modules that protoc generates from our protos have the same options."""
    (tmp_path / "google" / "rpc").mkdir(parents=True)
    for name in ("google/rpc/status.proto", "google/rpc/error_details.proto"):
        text = (PROJECT / "proto" / name).read_text()
        text = re.sub('go_package = "([^"]*)"', f'go_package = "{package}"', text)
        (tmp_path / name).write_text(text)
        protoc = ["protoc", f"-I{tmp_path}", f"--python_out={tmp_path}", name]
        subprocess.run(protoc, check=True)
    program = (
        f"import {first}, ballpiston\n"
        "from google.rpc import error_details_pb2, status_pb2\n"
        "from ballpiston._google_rpc import status_pb2 as ours\n"
        "print(ours.__file__)\n"
        "job = ballpiston.v1.ensemble_pb2.EnsembleJob(error=status_pb2.Status(message='m'))\n"
        "print(job.error.message)"
    )
    path = f"{tmp_path}:{Path(ballpiston.__file__).parents[1]}"
    printed = f"{tmp_path}/google/rpc/status_pb2.py\nm\n"
    reader = home.python(program, env=os.environ | {"PYTHONPATH": path})
    assert reader.communicate(timeout=LIMIT) == (printed, "")
