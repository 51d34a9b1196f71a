"""The address of a server as users write it.

    host:port    TCP; an IPv6 host in brackets, [::1]:50051
    unix:PATH    a Unix domain socket
"""

import ipaddress
import re

_LONGEST_SOCKET_PATH = 100  # bytes; sun_path holds 108 on Linux
_SOCKET_SCHEME = "unix:"
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
        path = address.removeprefix(_SOCKET_SCHEME)
        if set(path) & set("#?,%"):
            raise _bad_address(address, "gRPC cannot use a path with # ? , or %; ")
        if len(path.encode()) > _LONGEST_SOCKET_PATH:
            raise _bad_address(address, f"its path has more than {_LONGEST_SOCKET_PATH} bytes; ")
        if path:
            return address
    elif (found := _HOST_AND_PORT.fullmatch(address)) and 1 <= int(found[2]) <= 65535:
        return f"dns:///{address}"
    raise _bad_address(address)


def _bad_address(address: str, why: str = "") -> ValueError:
    return ValueError(
        f"{address!r} is not the address of a server: {why}write host:port, with a port from 1 to "
        "65535, or unix:PATH"
    )
