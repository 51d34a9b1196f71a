"""What to try if no connection comes about. gRPC's texts describe the network and OpenSSL, and do
not say what a user can do. The texts are those of gRPC 1.51 and OpenSSL 3."""

from __future__ import annotations

from ballpiston.channel_security import ChannelSecurity
from ballpiston.server_address import is_socket


def connection_hint(address: str, security: ChannelSecurity, message: str) -> str:
    """A line of its own for an error with this text; empty if nothing is known."""
    if is_socket(address):
        hint = _socket_hint(message)
    elif security.has_tls:
        hint = _tls_hint(security, message)
    else:
        hint = _plain_hint(message)
    return f"\n  {hint}" if hint else ""


def _was_closed(message: str) -> bool:
    return "Socket closed" in message or "Connection reset" in message


def _socket_hint(message: str) -> str:
    if not _was_closed(message) and "Permission denied" not in message:
        return ""
    return (
        "perhaps it is another user's server: only its own user can open a Unix socket; the users of "
        "a machine share a server at a loopback address, each with a token"
    )


def _plain_hint(message: str) -> str:
    if not _was_closed(message):
        return ""
    return "if that server wants TLS: ca=FILE, or tls=True if this system knows its authority"


def _tls_hint(security: ChannelSecurity, message: str) -> str:
    if "certificate verify failed" in message:
        authority = f"in {security.ca}" if security.ca else "that this system knows"
        return (
            "the server's certificate is not valid now, or was not signed by an authority "
            f"{authority}: name the right one with ca=FILE"
        )
    if "is not in peer certificate" in message:
        return "the server's certificate is for another host: write the host as it stands there"
    if "wrong version number" in message or "packet length too long" in message:
        return "that server does not use TLS: leave out ca and tls"
    return ""
