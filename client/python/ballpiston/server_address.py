"""The address of a server as users write it.

    host:port    TCP; an IPv6 host in brackets, [::1]:50051
    unix:PATH    a Unix domain socket
"""

from __future__ import annotations

import ipaddress

_LONGEST_SOCKET_PATH = 100  # bytes; sun_path holds 108 on Linux
_SOCKET_SCHEME = "unix:"


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
    """The target that gRPC wants.

    Raises:
        ValueError: this is not an address; the message shows the two forms.
    """
    if is_socket(address):
        return _socket_target(address)
    host, colon, port = address.rpartition(":")
    if not colon:
        raise _bad_address(address, "the port is missing")
    if not _is_host(host):
        raise _bad_address(address, "the host is not valid")
    if not (port.isascii() and port.isdecimal() and 1 <= int(port) <= 65535):
        raise _bad_address(address, "the port has to be a number from 1 to 65535")
    return f"dns:///{address}"


def _socket_target(address: str) -> str:
    path = address[len(_SOCKET_SCHEME) :]
    if not path:
        raise _bad_address(address, "the socket's path is missing")
    if len(path.encode()) > _LONGEST_SOCKET_PATH:
        raise _bad_address(address, f"the socket's path has more than {_LONGEST_SOCKET_PATH} bytes")
    return address


def _is_host(text: str) -> bool:
    if text.startswith("["):
        return len(text) > 2 and text.endswith("]")
    return bool(text) and not any(c in ":/[] \t" for c in text)


def _bad_address(address: str, why: str) -> ValueError:
    return ValueError(
        f"{address!r} is not the address of a server: {why} (write host:port or unix:PATH)"
    )
