"""A run of test programs in parallel parts, which ends at the first test that fails."""

from __future__ import annotations

import contextlib
import math
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

_PARTS = 4  # of each program


class Part:
    """A part of a program's tests, as a process."""

    def __init__(self, program: Path, index: int, temporary: Path, processor: str) -> None:
        """`processor`: seconds of processor time after which the kernel ends it, or `unlimited`."""
        self._command = ["prlimit", f"--cpu={processor}:", "setpriv", "--pdeathsig", "KILL", program]
        self._environment = {
            **os.environ,
            "GTEST_FAIL_FAST": "1",
            "GTEST_SHARD_INDEX": str(index),
            "GTEST_TOTAL_SHARDS": str(_PARTS),
            "TMPDIR": str(temporary),
        }
        self.output = temporary / f"{program.name}.{index}.log"
        self.starts = 0

    def start(self) -> None:
        self.starts += 1
        with self.output.open("w") as output:
            self._process = subprocess.Popen(
                self._command,
                env=self._environment,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )

    def has_ended(self) -> bool:
        return self._process.poll() is not None

    def kill(self) -> None:
        with contextlib.suppress(ProcessLookupError):  # it may have ended
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    def failed_test(self) -> str | None:
        code = self._process.returncode
        if code == 0:
            return None
        if failed := re.search(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", self.text(), re.MULTILINE):
            return failed[1]
        return f"{self.last_test()} (exit status {code})"

    def last_test(self) -> str:
        """The last test that began."""
        begun = re.findall(r"^\[ RUN      \] (\S+)", self.text(), re.MULTILINE)
        return begun[-1] if begun else self.output.stem

    def text(self) -> str:
        return self.output.read_text(errors="replace")


def first_failure(programs: list[Path], jobs: int, seconds: float, log: Path) -> str | None:
    """The first test that fails, or after so many seconds `hang: ` and the tests that still run.

    Each process of a part also ends after a fifth of `seconds` in processor time on each core: so an
    endless loop takes no longer on a busy machine. `log` gets the output of the parts. A part that
    fails or hangs runs once more, and only the second time counts, because a busy machine can make
    a test fail too.
    """
    temporary = Path(tempfile.mkdtemp(prefix="mutation-"))
    temporary.chmod(0o1777)  # like /tmp: a test is a server of several users
    processor = _fifth_on_all_cores(seconds)
    waiting = [Part(p, i, temporary, processor) for p in programs for i in range(_PARTS)]
    running: list[Part] = []
    has_hung = False
    deadline = time.monotonic() + seconds
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                running.append(waiting.pop(0))
                running[-1].start()
            time.sleep(0.1)
            if time.monotonic() > deadline:
                log.write_text("\n".join(part.text() for part in running))
                if has_hung:
                    return "hang: " + ", ".join(part.last_test() for part in running)
                for part in running:
                    part.kill()
                waiting, running = running + waiting, []
                has_hung, deadline = True, time.monotonic() + seconds
            for part in [part for part in running if part.has_ended()]:
                running.remove(part)
                failed = part.failed_test()
                if failed and part.starts > 1:
                    shutil.copy(part.output, log)
                    return failed
                if failed:
                    waiting.insert(0, part)
        return None
    finally:
        for part in running:
            part.kill()
        shutil.rmtree(temporary, ignore_errors=True)


def _fifth_on_all_cores(seconds: float) -> str:
    if math.isinf(seconds):
        return "unlimited"
    return str(math.ceil(seconds / 5 * (os.cpu_count() or 1)))
