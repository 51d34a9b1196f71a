"""What to try if no connection comes about: the texts of gRPC 1.51 and OpenSSL 3 do not say it."""

import re

from ballpiston.channel_security import ChannelSecurity
from ballpiston.server_address import is_socket

_OTHER_USER = (
    "perhaps it is another user's server: only its own user can open a Unix socket; the users of a "
    "machine share a server at a loopback address, each with a token"
)
_MAYBE_TLS = "if that server wants TLS: ca=FILE, or tls=True if this system knows its authority"
_WRONG_AUTHORITY = (
    "the server's certificate is not valid now, or was not signed by an authority {known}: name "
    "the right one with ca=FILE"
)
_WRONG_HOST = "the server's certificate is for another host: use a host name that it contains"
_NO_TLS = "that server does not use TLS: leave out ca and tls"
# The kind of channel, a pattern of gRPC's text, and what to try.
_HINTS = (
    ("socket", "Socket closed|Connection reset|Permission denied", _OTHER_USER),
    ("plain", "Socket closed|Connection reset", _MAYBE_TLS),
    ("tls", "certificate verify failed", _WRONG_AUTHORITY),
    ("tls", "is not in peer certificate", _WRONG_HOST),
    ("tls", "wrong version number|packet length too long", _NO_TLS),
)


def connection_hint(address: str, security: ChannelSecurity, message: str) -> str:
    """A line of its own for an error with this text; empty if nothing is known."""
    kind = "socket" if is_socket(address) else "tls" if security.has_tls else "plain"
    known = f"in {security.ca}" if security.ca else "that this system knows"
    for of, pattern, hint in _HINTS:
        if of == kind and re.search(pattern, message):
            return f"\n  {hint.format(known=known)}"
    return ""
