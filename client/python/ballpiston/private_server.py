"""The private server: it belongs to the user, is started when it is needed, and stops by itself
after a minute without work.

The program `ballpiston` knows how to find and start it: `ballpiston server address` prints its
address, and starts it first if it does not run. So notebooks and the command line share one server
and its stored answers, in $XDG_STATE_HOME/ballpiston or ~/.local/state/ballpiston.
"""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ballpiston.errors import NoPrivateServer
from ballpiston.server_address import is_socket

_PROGRAM = "ballpiston"
_START_TIME = 120.0  # seconds; the program itself gives up after a minute


@dataclass(frozen=True)
class PrivateServer:
    """The user's private server, by means of `program`, a path of the program `ballpiston`."""

    program: str

    def address(self) -> str:
        """Its address, unix:PATH. Starts the server if it does not run. Raises NoPrivateServer: the
        program cannot be run, or cannot start the server."""
        try:
            answer = subprocess.run(
                [self.program, "server", "address"],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                encoding="utf-8",  # gRPC's addresses are UTF-8 in every locale
                errors="replace",
                timeout=_START_TIME,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise NoPrivateServer(f"cannot start the private server: {error}") from error
        address = answer.stdout.strip()
        if answer.returncode == 0 and is_socket(address):
            return address
        why = answer.stderr.strip().removeprefix(f"{_PROGRAM}: ") or "no address was printed"
        failure = NoPrivateServer(f"cannot start the private server with {self.program}: {why}")
        failure.exit_code = answer.returncode
        raise failure


def find_private_server() -> PrivateServer:
    """With the program that BALLPISTON_PROGRAM names, else the one that is installed with this
    package, else the one in PATH. Raises NoPrivateServer: there is no program."""
    program = os.environ.get("BALLPISTON_PROGRAM") or _program_beside_package()
    program = program or shutil.which(_PROGRAM)
    if program:
        return PrivateServer(program)
    raise NoPrivateServer(
        "the program ballpiston, which starts the private server, was not found: install the "
        'package ballpiston, or name a server: ballpiston.connect("host:port")'
    )


def _program_beside_package() -> str | None:
    """PREFIX/bin/ballpiston for a package in PREFIX/lib/python3/dist-packages or, in a folder of a
    build, in PREFIX/python."""
    parents = Path(__file__).resolve().parent.parents
    for level in (1, 3):
        if level < len(parents):
            program = parents[level] / "bin" / _PROGRAM
            if os.access(program, os.X_OK) and program.is_file():
                return str(program)
    return None
