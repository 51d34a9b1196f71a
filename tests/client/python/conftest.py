"""Fixtures: private servers in folders of their own, with the programs in the folder that the
variable BALLPISTON_BIN names, and the package from PYTHONPATH:

    export BALLPISTON_BIN=build/release/bin PYTHONPATH=build/release/python
    python3 -m pytest tests/client/python
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import ballpiston

PROJECT = Path(__file__).resolve().parents[3]
LIMIT = 900.0  # seconds: the longest wait for a condition or a program

# A shell starts background commands with SIGINT ignored, and their child processes inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)


def wait_until(condition: Callable[[], Any]) -> Any:
    """The first true value of the condition."""
    deadline = time.monotonic() + LIMIT
    while time.monotonic() < deadline:
        if value := condition():
            return value
        time.sleep(0.01)
    pytest.fail(f"the condition is still false after {LIMIT} seconds")


class Home:
    """A user's private server, with its state in `folder`."""

    def __init__(self, folder: Path) -> None:
        programs = os.environ.get("BALLPISTON_BIN")
        assert programs, "the variable BALLPISTON_BIN has to name the folder of the programs"
        self.programs = Path(programs).resolve()
        self.folder = folder

    def enter(self, patch: pytest.MonkeyPatch) -> None:
        """Makes this the home of the test's process, without other settings of the user."""
        for name in list(os.environ):
            if name.startswith("BALLPISTON_") and name != "BALLPISTON_BIN":
                patch.delenv(name)
        patch.setenv("BALLPISTON_PROGRAM", str(self.programs / "ballpiston"))
        patch.setenv("BALLPISTON_PYTHON", sys.executable)
        patch.setenv("XDG_CONFIG_HOME", str(self.folder / "config"))
        for name in ("HOME", "XDG_RUNTIME_DIR", "XDG_STATE_HOME"):
            patch.setenv(name, str(self.folder))

    def run(self, *words: str, **options: Any) -> subprocess.CompletedProcess[str]:
        """The command line, at its end."""
        command = [str(self.programs / "ballpiston"), *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, **options)

    def command(self, *words: str) -> str:
        """What the command line prints."""
        ended = self.run(*words)
        assert ended.returncode == 0, ended.stderr
        return ended.stdout

    def python(self, program: str, *arguments: str, **options: Any) -> subprocess.Popen[str]:
        """Another process that runs a Python program."""
        command = [sys.executable, "-c", program, *arguments]
        return subprocess.Popen(command, text=True, **{"stdout": -1, "stderr": -1} | options)

    def server_id(self) -> int | None:
        """The process id of the server; None if none runs. The file keeps the id of a server that
        was killed, and another process may have it by now."""
        with contextlib.suppress(OSError, ValueError):
            process = int((self.folder / "ballpiston" / "lock").read_text())
            if str(self.folder).encode() in Path(f"/proc/{process}/cmdline").read_bytes():
                return process
        return None

    def end_server(self, how: signal.Signals) -> None:
        """Ends the server and waits until its process is gone."""
        process = self.server_id()
        if process is None:
            return
        with contextlib.suppress(ProcessLookupError), os.fdopen(os.pidfd_open(process)) as handle:
            os.kill(process, how)
            ended, _, _ = select.select([handle], [], [], LIMIT)
            assert ended, f"the server has not ended after {LIMIT} seconds"


@pytest.fixture(scope="session", autouse=True)
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Home]:
    """One server for all tests that do not end it."""
    home = Home(tmp_path_factory.mktemp("home"))
    with pytest.MonkeyPatch.context() as patch:
        home.enter(patch)
        yield home
    home.end_server(signal.SIGTERM)


@pytest.fixture
def own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Home]:
    """A server that the test may end."""
    home = Home(tmp_path)
    home.enter(monkeypatch)
    yield home
    home.end_server(signal.SIGKILL)


@pytest.fixture(scope="session")
def client(home: Home) -> Iterator[ballpiston.Client]:
    with ballpiston.connect(timeout=LIMIT) as client:
        yield client


# A few milliseconds of computing.
FIRST_HITS: dict[str, Any] = {
    "experiment": "first-hit",
    "rho": 0.5296,
    "delta": [0.1, 0.05],
    "epsilon": 0.125,
    "exponent": [1, 2],
    "samples": 2000,
    "seed": 7,
}

# Would take hours: tests cancel it.
ENDLESS: dict[str, Any] = {**FIRST_HITS, "delta": 0.01, "exponent": 1, "samples": 1e11}


@pytest.fixture
def endless(client: ballpiston.Client) -> Iterator[ballpiston.Job]:
    """A job that runs; it is cancelled at the end of the test."""
    job = client.submit(**ENDLESS, fresh=True)
    yield job
    if not job.has_ended:
        job.cancel()


@pytest.fixture(scope="session")
def first_hits(client: ballpiston.Client) -> ballpiston.Result:
    """A result with histograms and curves, four points."""
    return client.run(**FIRST_HITS, fresh=True)
