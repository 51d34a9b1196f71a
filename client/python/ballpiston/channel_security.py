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
import pwd
import socket
import stat
from contextlib import suppress
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


def check_security(security: ChannelSecurity, address: str) -> None:
    """Whether these go together, and with the address. Reads no file. Raises ValueError: says what
    does not fit, for instance a token without TLS."""
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
    """gRPC's credentials, or None for a channel without encryption. Reads the authority file, which
    has to look like PEM: gRPC would report only that there is no connection. Raises ValueError:
    names a file that cannot be used."""
    if not security.has_tls:
        return None
    authorities = None
    if security.ca:
        authorities = _contents(security.ca, "authority file", is_secret=False)
        if (first := "-----BEGIN CERTIFICATE-----").encode() not in authorities:
            raise ValueError(
                f'the authority file {security.ca} is not a PEM file: it does not contain "{first}"'
            )
    return grpc.ssl_channel_credentials(root_certificates=authorities)


def token_of(security: ChannelSecurity) -> str:
    """The token, or that in the token file. Raises ValueError: not a token, or a file that cannot
    be read; PermissionDenied: other users can read the file."""
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
            mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
            if is_secret and mode & (stat.S_IRWXG | stat.S_IRWXO):
                raise PermissionDenied(
                    f"the {what} {path} is open to other users (mode {mode:04o}): run chmod "
                    "600 on it; if others may have read it, request a new one"
                )
            data = file.read(_MOST_FILE_BYTES + 1)
    except OSError as error:
        raise ValueError(f"the {what} {path} cannot be read: {error.strerror}") from error
    if len(data) > _MOST_FILE_BYTES:
        raise ValueError(f"the {what} {path} is longer than {_MOST_FILE_BYTES} bytes")
    return data


class Token:
    """The token that calls send. A given token file is read once. The token of the user's own
    server is read for each call.

    Raises:
        ValueError: names a file that cannot be used.
        PermissionDenied: names a secret file that other users can read.
    """

    def __init__(self, security: ChannelSecurity, address: str) -> None:
        self._token = token_of(security) if security.has_token else ""
        has_own_server = not self._token and not security.has_tls and is_loopback(address)
        self._own_server = address if has_own_server else ""

    def metadata(self) -> list[tuple[str, str]]:
        """The metadata of a call."""
        token = self._token
        if self._own_server:
            with suppress(OSError):  # no such server, or no home folder
                tokens = user_folder("XDG_STATE_HOME", ".local/state") / "tokens"
                token = (tokens / socket.gethostname() / self._own_server).read_text().strip()
        return [("authorization", f"Bearer {token}")] if token else []


def user_folder(variable: str, default: str) -> Path:
    """The user's folder `ballpiston`. It is in the folder that the XDG variable names if this path
    is absolute, otherwise in `default` below the home folder. The home folder is HOME if it is an
    absolute path, otherwise that of the user's entry in the password database. Raises OSError: the
    user has no entry."""
    root = os.environ.get(variable, "")
    if not root.startswith("/"):
        home = os.environ.get("HOME", "")
        try:
            home = home if home.startswith("/") else pwd.getpwuid(os.getuid()).pw_dir
        except KeyError:
            raise FileNotFoundError("no home folder") from None
        root = f"{home}/{default}"
    return Path(root) / "ballpiston"
