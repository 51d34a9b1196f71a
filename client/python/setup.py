"""For pip: the sources with the protocol's modules (build_package.py)."""

from __future__ import annotations

import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

sys.path.insert(0, str(Path(__file__).resolve().parent))
from build_package import build, version  # noqa: E402


class BuildPackage(build_py):
    """Replaces the copying of sources."""

    def run(self) -> None:
        build(Path(self.build_lib))


setup(version=version(), cmdclass={"build_py": BuildPackage})
