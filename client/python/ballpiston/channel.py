"""Channels to a server, set up for long watches.

Calls that are safe to repeat are retried for about a second while the server is unreachable: all
but deletions (creations and cancellations carry a request id). If the server says how long to wait
before a retry, gRPC waits so long. Watches attach again by themselves (watch.py).

How the client and the server authenticate each other:

    nothing set        no encryption: a Unix socket, or a server on the loopback
    tls                TLS; the system's certificate authorities verify the server
    ca                 TLS; the certificate authorities in this file verify the server
    token              sent with every call, over TLS or to a loopback address

Without TLS and without a token, the client sends to a loopback address the token of the user's own
server, if one listens there. The server makes a token at each start, and keeps it in a file that
only its user can read, in a folder for each machine that shares the user's home folder:

    $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
"""

import json
import os
import re
import socket
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import grpc

from ballpiston._version import __version__
from ballpiston.errors import PermissionDenied
from ballpiston.server_address import grpc_target, is_loopback, is_socket

_ENSEMBLES = "ballpiston.v1.EnsembleService"
_RETRIES = {
    "maxAttempts": 4,
    "initialBackoff": "0.1s",
    "maxBackoff": "1s",
    "backoffMultiplier": 2,
    "retryableStatusCodes": ["UNAVAILABLE", "CANCELLED"],
}
# A method's own entry wins over the default: these are not retried.
_ONCE = [{"service": _ENSEMBLES, "method": f"{verb}EnsembleJob"} for verb in ("Watch", "Delete")]
_SERVICE_CONFIG = {"methodConfig": [{"name": [{}], "retryPolicy": _RETRIES}, {"name": _ONCE}]}

_ARGUMENTS: list[tuple[str, int | str]] = [
    ("grpc.primary_user_agent", f"ballpiston/{__version__} (python)"),
    ("grpc.keepalive_time_ms", 30_000),
    ("grpc.keepalive_timeout_ms", 10_000),
    # A watch only listens: without this the pings stop after two, and nobody sees that a connection
    # is dead.
    ("grpc.http2.max_pings_without_data", 0),
    # gRPC's own pauses between attempts to connect grow to two minutes: too long for a watch that
    # waits for a server to come back.
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 2_000),
    # A server on this machine or in this laboratory is not behind the web proxy.
    ("grpc.enable_http_proxy", 0),
    ("grpc.max_receive_message_length", -1),  # the server decides how large its answers are
    ("grpc.service_config", json.dumps(_SERVICE_CONFIG)),
]
_MOST_FILE_BYTES = 1 << 20
_LONGEST_TOKEN = 256

# What to try if no connection comes about: gRPC 1.51 and OpenSSL 3 do not say what a user can do.
_OTHER_USER = (
    "perhaps it is another user's server: only its own user can open a Unix socket; the users of a "
    "machine share a server at a loopback address, each with a token"
)
_MAYBE_TLS = "if that server wants TLS: ca=FILE, or tls=True if this system knows its authority"
_WRONG_AUTHORITY = (
    "the server's certificate is not valid now, or was not signed by an authority {known}: name "
    "the right one with ca=FILE"
)
_WRONG_HOST = "the server's certificate is for another host: write the host as it stands there"
_NO_TLS = "that server does not use TLS: leave out ca and tls"
# The kind of channel, a pattern of gRPC's text, and what to try.
_HINTS = (
    ("socket", "Socket closed|Connection reset|Permission denied", _OTHER_USER),
    ("plain", "Socket closed|Connection reset", _MAYBE_TLS),
    ("tls", "certificate verify failed", _WRONG_AUTHORITY),
    ("tls", "is not in peer certificate", _WRONG_HOST),
    ("tls", "wrong version number|packet length too long", _NO_TLS),
)


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
            mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
            if is_secret and mode & (stat.S_IRWXG | stat.S_IRWXO):
                raise PermissionDenied(
                    f"the {what} {path} is open to other users (mode {mode:04o}): chmod 600 it, "
                    "and if others may have read it ask for a new one"
                )
            data = file.read(_MOST_FILE_BYTES + 1)
    except OSError as error:
        raise ValueError(f"the {what} {path} cannot be read: {error.strerror}") from error
    if len(data) > _MOST_FILE_BYTES:
        raise ValueError(f"the {what} {path} is longer than {_MOST_FILE_BYTES} bytes")
    return data


def open_channel(address: str, security: ChannelSecurity, module: Any = grpc) -> Any:
    """A grpc.Channel, which does not connect yet. With `module` grpc.aio the channel is for an
    event loop, and only the loop that opened it may use it. Raises ValueError: not an address, or
    security that does not fit together or cannot be read."""
    target = grpc_target(address)
    check(security, address)
    credentials = credentials_of(security)
    if credentials is None:
        return module.insecure_channel(target, options=_ARGUMENTS)
    return module.secure_channel(target, credentials, options=_ARGUMENTS)


def connection_hint(address: str, security: ChannelSecurity, message: str) -> str:
    """A line of its own for an error with this text; empty if nothing is known."""
    kind = "socket" if is_socket(address) else "tls" if security.has_tls else "plain"
    known = f"in {security.ca}" if security.ca else "that this system knows"
    for of, pattern, hint in _HINTS:
        if of == kind and re.search(pattern, message):
            return f"\n  {hint.format(known=known)}"
    return ""
