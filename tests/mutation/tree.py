"""A copy of a commit, in which mutants are built. The repository itself is never changed."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

# The fast test programs of each folder, and the program that has its main function.
TESTS = {
    "core": ["core_test"],
    "server": ["server_test", "worker_test", "store_fault_test", "simulation_test"],
    "client": ["client_test", "interrupts_test"],
}
PROGRAMS = {"core": [], "server": ["ballpistond"], "client": ["ballpiston"]}


class Tree:
    def __init__(self, root: Path, folder: Path, commit: str, jobs: int) -> None:
        self.path = folder / "tree"
        self.build = self.path / "build/release"
        self._log = folder / "build.log"
        self.jobs = jobs
        if not self.path.exists():
            _run("git", "clone", "-q", "--shared", "--no-checkout", root, self.path)
        _run("git", "-C", self.path, "checkout", "-q", "--force", "--detach", commit)
        with self._log.open("w") as log:
            _run("cmake", "--preset", "release", "-DBALLPISTON_TESTS=ON", cwd=self.path, stdout=log)

    def builds(self, folder: str) -> bool:
        command = ["cmake", "--build", self.build, "-j", str(self.jobs), "--target"]
        with self._log.open("w") as log:
            return not subprocess.call(
                [*command, *TESTS[folder], *PROGRAMS[folder]], stdout=log, stderr=log
            )


def _run(*command: str | Path, **options: Any) -> None:
    subprocess.run(command, check=True, **options)
