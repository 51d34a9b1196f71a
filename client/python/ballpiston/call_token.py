"""The token that calls send.

Without TLS and without a token, the client sends to a loopback address the token of the user's own
server, if one listens there. The server makes a token at each start, and keeps it in a file that
only its user can read, in a folder for each machine that shares the user's home folder:

    $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
"""

import os
import socket
from pathlib import Path

from ballpiston.channel_security import ChannelSecurity, token_of
from ballpiston.server_address import is_loopback
from ballpiston.settings import home_folder


class Token:
    """The token that calls send. A given token file is read once. The token of the user's own
    server is read for each call.

    Raises:
        ValueError: names a file that cannot be used.
        PermissionDenied: names a secret file that other users can read.
    """

    def __init__(self, security: ChannelSecurity, address: str) -> None:
        self._given = token_of(security) if security.has_token else ""
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
        root = Path(state) if state.startswith("/") else home_folder() / ".local" / "state"
        return (root / "ballpiston" / "tokens" / socket.gethostname() / address).read_text().strip()
    except (OSError, RuntimeError):  # RuntimeError: no home folder
        return ""
