"""The private server: it belongs to the user, is started when it is needed, and stops by itself
after a minute without work.

The program `ballpiston` knows how to find and start it: `ballpiston server address` prints its
address, and starts it first if it does not run. So notebooks and the command line share one server
and its stored answers, in $XDG_STATE_HOME/ballpiston or ~/.local/state/ballpiston.
"""

import os
import shutil
import subprocess
from pathlib import Path

from ballpiston.errors import NoPrivateServer
from ballpiston.server_address import is_socket

_PROGRAM = "ballpiston"
_START_TIME = 120.0  # seconds; the program itself gives up after a minute


def private_address(program: str) -> str:
    """The address of the user's private server, unix:PATH. `program` is the path of `ballpiston`.
    Raises NoPrivateServer: the program cannot be run, or cannot start the server."""
    try:
        answer = subprocess.run(
            [program, "server", "address"],
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
    failure = NoPrivateServer(f"cannot start the private server with {program}: {why}")
    failure.exit_code = answer.returncode
    raise failure


def find_program() -> str:
    """The path of the program `ballpiston`: from BALLPISTON_PROGRAM, otherwise in PREFIX/bin,
    otherwise in PATH. The package is in PREFIX/lib/python3/dist-packages, or in PREFIX/python of a
    build folder. Raises NoPrivateServer: there is none."""
    if named := os.environ.get("BALLPISTON_PROGRAM"):
        return named
    beside_package = [up / "bin" / _PROGRAM for up in Path(__file__).resolve().parents[2:5:2]]
    for program in map(str, (*beside_package, _PROGRAM)):
        if found := shutil.which(program):
            return found
    raise NoPrivateServer(
        "the program ballpiston, which starts the private server, was not found: install the "
        'package ballpiston, or name a server: ballpiston.connect("host:port")'
    )
