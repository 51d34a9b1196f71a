"""Builds a copy of a commit, with or without a mutant, and runs the fast tests of a folder."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

# The fast test programs of each folder, and the program that has its main function.
TESTS = {
    "core": ["core_test"],
    "server": ["server_test", "worker_test", "store_fault_test"],
    "client": ["client_test", "interrupts_test"],
}
PROGRAMS = {"core": [], "server": ["ballpistond"], "client": ["ballpiston"]}
SHARDS = 4  # parts of each test program


class Tree:
    """A clone of the repository, in which alone something is changed."""

    def __init__(self, root: Path, folder: Path, commit: str, jobs: int) -> None:
        self.path = folder / "tree"
        self._build = self.path / "build/release"
        self._log = folder / "build.log"
        self._jobs = jobs
        if not self.path.exists():
            _run("git", "clone", "-q", "--shared", "--no-checkout", root, self.path)
        _run("git", "-C", self.path, "checkout", "-q", "--force", "--detach", commit)
        with self._log.open("w") as log:
            _run("cmake", "--preset", "release", "-DBALLPISTON_TESTS=ON", cwd=self.path, stdout=log)

    def builds(self, folder: str) -> bool:
        command = ["cmake", "--build", self._build, "-j", str(self._jobs), "--target"]
        with self._log.open("w") as log:
            return not subprocess.call(
                [*command, *TESTS[folder], *PROGRAMS[folder]], stdout=log, stderr=log
            )

    def failure(self, folder: str, limit: float) -> str | None:
        """The first test that fails, `hang` after so many seconds, or None if all tests pass."""
        waiting = [(name, shard) for name in TESTS[folder] for shard in range(SHARDS)]
        deadline = time.monotonic() + limit
        temporary = Path(tempfile.mkdtemp(prefix="mutation-"))
        temporary.chmod(0o1777)  # like /tmp: a test is a server of several users
        running: dict[Path, subprocess.Popen[bytes]] = {}
        try:
            while waiting or running:
                while waiting and len(running) < self._jobs:
                    name, shard = waiting.pop(0)
                    output = temporary / f"{name}.{shard}.log"
                    running[output] = _start(self._build / "bin" / name, shard, output)
                time.sleep(0.1)
                if time.monotonic() > deadline:
                    return "hang"
                ended = [path for path, process in running.items() if process.poll() is not None]
                for output in ended:
                    if code := running.pop(output).returncode:
                        shutil.copy(output, self._log.with_name("failure.log"))
                        return _failed_test(output, code)
            return None
        finally:
            for process in running.values():
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            shutil.rmtree(temporary, ignore_errors=True)


def _run(*command: str | Path, **options: Any) -> None:
    subprocess.run(command, check=True, **options)


def _start(program: Path, shard: int, output: Path) -> subprocess.Popen[bytes]:
    environment = {
        **os.environ,
        "GTEST_FAIL_FAST": "1",
        "GTEST_SHARD_INDEX": str(shard),
        "GTEST_TOTAL_SHARDS": str(SHARDS),
        "TMPDIR": str(output.parent),
    }
    with output.open("w") as file:
        return subprocess.Popen(
            [program], env=environment, stdout=file, stderr=file, start_new_session=True
        )


def _failed_test(output: Path, code: int) -> str:
    text = output.read_text(errors="replace")
    if failed := re.search(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", text, re.MULTILINE):
        return failed[1]
    if hanging := re.search(r"^\[  HANGS   \] (.*) has not ended", text, re.MULTILINE):
        return f"{hanging[1]} (hang)"
    begun = re.findall(r"^\[ RUN      \] (\S+)", text, re.MULTILINE)
    return f"{begun[-1] if begun else output.stem} (exit status {code})"
