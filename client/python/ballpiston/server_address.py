"""The address of a server as users write it.

    host:port    TCP; an IPv6 host in brackets, [::1]:50051
    unix:PATH    a Unix domain socket

The private server: it belongs to the user, is started when it is needed, and stops by itself
after a minute without work.

The program `ballpiston` knows how to find and start it: `ballpiston server address` prints its
address, and starts it first if it does not run. So notebooks and the command line share one server
and its stored answers, in $XDG_STATE_HOME/ballpiston or ~/.local/state/ballpiston.
"""

import ipaddress
import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ballpiston.errors import NoPrivateServer

_LONGEST_SOCKET_PATH = 100  # bytes; sun_path holds 108 on Linux
_SOCKET_SCHEME = "unix:"
_PROGRAM = "ballpiston"
_START_TIME = 120.0  # seconds; the program itself gives up after a minute
_HOST_AND_PORT = re.compile(r"(\[[^\[\]]+\]|[^:/\[\] \t]+):([0-9]{1,5})")


def is_socket(address: str) -> bool:
    """Whether it is the address of a Unix socket."""
    return address.startswith(_SOCKET_SCHEME)


def literal_address(address: str) -> str:
    """The address with 127.0.0.1 instead of the name localhost. The name could also mean ::1, where
    another user's server may listen."""
    host, _, port = address.rpartition(":")
    return f"127.0.0.1:{port}" if host == "localhost" else address


def is_loopback(address: str) -> bool:
    """Whether only programs of this machine can listen at the address."""
    host = address.rpartition(":")[0]
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def grpc_target(address: str) -> str:
    """The target that gRPC wants. Raises ValueError: this is not an address; the message shows the
    two forms."""
    if is_socket(address):
        length = len(address.removeprefix(_SOCKET_SCHEME).encode())
        if length > _LONGEST_SOCKET_PATH:
            raise _bad_address(address, f"its path has more than {_LONGEST_SOCKET_PATH} bytes; ")
        if length > 0:
            return address
    elif (found := _HOST_AND_PORT.fullmatch(address)) and 1 <= int(found[2]) <= 65535:
        return f"dns:///{address}"
    raise _bad_address(address)


def _bad_address(address: str, why: str = "") -> ValueError:
    return ValueError(
        f"{address!r} is not the address of a server: {why}write host:port, with a port from 1 to "
        "65535, or unix:PATH"
    )


@dataclass(frozen=True)
class PrivateServer:
    """The user's private server, by means of `program`, a path of the program `ballpiston`."""

    program: str

    def address(self) -> str:
        """Its address, unix:PATH. Starts the server if it does not run. Raises NoPrivateServer: the
        program cannot be run, or cannot start the server."""
        try:
            command, nothing = [self.program, "server", "address"], subprocess.DEVNULL
            answer = subprocess.run(
                command, stdin=nothing, capture_output=True, text=True, timeout=_START_TIME
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise NoPrivateServer(f"cannot start the private server: {error}") from error
        address = answer.stdout.strip()
        if answer.returncode == 0 and is_socket(address):
            return address
        why = answer.stderr.strip().removeprefix(f"{_PROGRAM}: ") or "no address was printed"
        raise NoPrivateServer(f"cannot start the private server with {self.program}: {why}")


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
