#!/usr/bin/env python3
"""Builds the Python package: build_package.py FOLDER writes FOLDER/ballpiston.

The package is the sources in this folder, a module with the project's version, and the modules of
the protocol, which protoc generates from the project's proto files. The build with CMake and pip
(setup.py) both call `build`.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_HERE = Path(__file__).resolve().parent
_PROJECT = _HERE.parents[1]
_PROTOS = _PROJECT / "proto"


def build(folder: Path) -> None:
    """Writes the package; files that it had there before are replaced."""
    package = folder / "ballpiston"
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(_HERE / "ballpiston", package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "_version.py").write_text(
        f'"""The version of this package: that of the whole project."""\n\n'
        f'__version__ = "{version()}"\n'
    )
    _write_protocol(package)


def version() -> str:
    """The project's version, from its CMakeLists.txt."""
    found = re.search(r"\(ballpiston VERSION (\S+)", (_PROJECT / "CMakeLists.txt").read_text())
    if found is None:
        raise SystemExit(f"{_PROJECT}/CMakeLists.txt names no version of ballpiston")
    return found[1]


def _write_protocol(package: Path) -> None:
    protos = sorted([*_PROTOS.glob("ballpiston/v1/*.proto"), *_PROTOS.glob("google/rpc/*.proto")])
    services = [proto for proto in protos if re.search(r"^service ", proto.read_text(), re.M)]
    plugin = shutil.which("grpc_python_plugin")
    if plugin is None or shutil.which("protoc") is None:
        raise SystemExit("install the packages protobuf-compiler and protobuf-compiler-grpc")
    with tempfile.TemporaryDirectory() as generated:
        protoc = ["protoc", f"-I{_PROTOS}"]
        subprocess.run([*protoc, f"--python_out={generated}", *protos], check=True)
        of_services = [f"--plugin=protoc-gen-grpc={plugin}", f"--grpc_out={generated}", *services]
        subprocess.run([*protoc, *of_services], check=True)
        for module in Path(generated).rglob("*.py"):
            _place(module, package)


def _place(module: Path, package: Path) -> None:
    """The folder `google` belongs to other packages, so this package has modules of its own."""
    is_google = module.parent.name == "rpc"
    text = module.read_text().replace("from google.rpc", "from ballpiston._google_rpc")
    (package / ("_google_rpc" if is_google else "v1") / module.name).write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} FOLDER")
    build(Path(sys.argv[1]))
