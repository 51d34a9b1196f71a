"""How the client and the server authenticate each other.

    nothing set        no encryption: a Unix socket, or a server on the loopback
    tls                TLS; the system's certificate authorities verify the server
    ca                 TLS; the certificate authorities in this file verify the server
    token              sent with every call, over TLS or to a loopback address

Without TLS and without a token, the client sends to a loopback address the token of the user's own
server, if one listens there. The server makes a token at each start, and keeps it in a file that
only its user can read, in a folder for each machine that shares the user's home folder:

    $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
"""

import os
import socket
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import grpc

from ballpiston.errors import PermissionDenied
from ballpiston.server_address import is_loopback, is_socket

_MOST_FILE_BYTES = 1 << 20
_LONGEST_TOKEN = 256


@dataclass(frozen=True)
class ChannelSecurity:
    """The files and the token. Empty: not given."""

    tls: bool = False
    ca: str = ""
    token_file: str = ""
    token: str = field(default="", repr=False)

    @property
    def has_tls(self) -> bool:
        return self.tls or bool(self.ca)

    @property
    def has_token(self) -> bool:
        return bool(self.token_file or self.token)


def check(security: ChannelSecurity, address: str) -> None:
    """Whether these go together, and with the address. Reads no file.

    Raises:
        ValueError: says what does not fit, for instance a token without TLS.
    """
    if is_socket(address) and (security.has_tls or security.has_token):
        raise ValueError(
            "a Unix socket uses no TLS and no token: only the server's own user can open it"
        )
    if security.has_token and not security.has_tls and not is_loopback(address):
        raise ValueError(
            "a token is not sent to another machine over a connection that others can read: use TLS "
            "(ca=FILE, or tls=True for the authorities of this system)"
        )


def credentials_of(security: ChannelSecurity) -> Any | None:
    """gRPC's credentials, or None for a channel without encryption. Reads the authority file.

    Raises:
        ValueError: names a file that cannot be used.
    """
    if not security.has_tls:
        return None
    authorities = _authorities(security.ca) if security.ca else None
    return grpc.ssl_channel_credentials(root_certificates=authorities)


class Token:
    """The token that calls send. A given token file is read once. The token of the user's own
    server is read for each call.

    Raises:
        ValueError: names a file that cannot be used.
        PermissionDenied: names a secret file that other users can read.
    """

    def __init__(self, security: ChannelSecurity, address: str) -> None:
        self._given = _token_of(security) if security.has_token else ""
        self._own_server = "" if security.has_tls or not is_loopback(address) else address

    def metadata(self) -> list[tuple[str, str]]:
        """The metadata of a call."""
        token = self._given or (_own_token(self._own_server) if self._own_server else "")
        return [("authorization", f"Bearer {token}")] if token else []


def _own_token(address: str) -> str:
    """The token in the server's file; empty if there is none. It is read for each call, because a
    server makes another token at each start."""
    state = os.environ.get("XDG_STATE_HOME", "")
    try:
        root = Path(state) if state.startswith("/") else Path.home() / ".local" / "state"
        return (root / "ballpiston" / "tokens" / socket.gethostname() / address).read_text().strip()
    except (OSError, RuntimeError):  # RuntimeError: no home folder
        return ""


def _authorities(path: str) -> bytes:
    """The file's bytes. Checks that they look like PEM, because gRPC would report only that there
    is no connection."""
    data = _contents(path, "authority file", is_secret=False)
    if b"-----BEGIN CERTIFICATE-----" not in data:
        raise ValueError(
            f'the authority file {path} does not contain "-----BEGIN CERTIFICATE-----": it has to '
            "be a PEM file"
        )
    return data


def _token_of(security: ChannelSecurity) -> str:
    token, what = security.token, "the token"
    if security.token_file:
        what = f"the token file {security.token_file}"
        data = _contents(security.token_file, "token file", is_secret=True)
        token = data.decode("ascii", "replace").strip()
    if 1 <= len(token) <= _LONGEST_TOKEN and all("!" <= c <= "~" for c in token):
        return token
    raise ValueError(f"{what} has to be one word of 1 to {_LONGEST_TOKEN} printable characters")


def _contents(path: str, what: str, is_secret: bool) -> bytes:
    try:
        with Path(path).open("rb") as file:
            if is_secret:
                _check_that_only_its_owner_reads(path, what, os.fstat(file.fileno()).st_mode)
            data = file.read(_MOST_FILE_BYTES + 1)
    except OSError as error:
        raise ValueError(f"the {what} {path} cannot be read: {error.strerror}") from error
    if len(data) > _MOST_FILE_BYTES:
        raise ValueError(f"the {what} {path} is longer than {_MOST_FILE_BYTES} bytes")
    return data


def _check_that_only_its_owner_reads(path: str, what: str, mode: int) -> None:
    if mode & (stat.S_IRWXG | stat.S_IRWXO) == 0:
        return
    raise PermissionDenied(
        f"the {what} {path} is open to other users (mode {stat.S_IMODE(mode):04o}): "
        "chmod 600 it, and if others may have read it ask for a new one"
    )
