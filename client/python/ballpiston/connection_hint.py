"""What to try if no connection comes about. gRPC's texts describe the network and OpenSSL, and do
not say what a user can do. The texts are those of gRPC 1.51 and OpenSSL 3."""

from __future__ import annotations

from ballpiston.channel_security import ChannelSecurity
from ballpiston.server_address import is_socket

# The kind of channel, parts of gRPC's text, and what to try.
_HINTS = (
    (
        "socket",
        ("Socket closed", "Connection reset", "Permission denied"),
        "perhaps it is another user's server: only its own user can open a Unix socket; the users of "
        "a machine share a server at a loopback address, each with a token",
    ),
    (
        "plain",
        ("Socket closed", "Connection reset"),
        "if that server wants TLS: ca=FILE, or tls=True if this system knows its authority",
    ),
    (
        "tls",
        ("certificate verify failed",),
        "the server's certificate is not valid now, or was not signed by an authority {known}: name "
        "the right one with ca=FILE",
    ),
    (
        "tls",
        ("is not in peer certificate",),
        "the server's certificate is for another host: write the host as it stands there",
    ),
    (
        "tls",
        ("wrong version number", "packet length too long"),
        "that server does not use TLS: leave out ca and tls",
    ),
)


def connection_hint(address: str, security: ChannelSecurity, message: str) -> str:
    """A line of its own for an error with this text; empty if nothing is known."""
    kind = "socket" if is_socket(address) else "tls" if security.has_tls else "plain"
    known = f"in {security.ca}" if security.ca else "that this system knows"
    for of, parts, hint in _HINTS:
        if of == kind and any(part in message for part in parts):
            return f"\n  {hint.format(known=known)}"
    return ""
