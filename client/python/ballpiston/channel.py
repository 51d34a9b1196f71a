"""Channels to a server, set up for long watches.

Calls that are safe to repeat are retried for about a second while the server is unreachable: all
but deletions (creations and cancellations carry a request id). If the server says how long to wait
before a retry, gRPC waits so long. Watches attach again by themselves (watch.py).
"""

import json
from typing import Any

import grpc

from ballpiston._version import __version__
from ballpiston.channel_security import ChannelSecurity, check_security, credentials_of
from ballpiston.server_address import grpc_target

_ENSEMBLES = "ballpiston.v1.EnsembleService"
_RETRIES = {
    "maxAttempts": 4,
    "initialBackoff": "0.1s",
    "maxBackoff": "1s",
    "backoffMultiplier": 2,
    "retryableStatusCodes": ["UNAVAILABLE", "CANCELLED"],
}
# A method's own entry overrides the default: these are not retried.
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


def open_channel(address: str, security: ChannelSecurity, module: Any = grpc) -> Any:
    """A grpc.Channel, which does not connect yet. With `module` grpc.aio the channel is for an
    event loop, and only the loop that opened it may use it. Raises ValueError: not an address, or
    security that does not fit together or cannot be read."""
    target = grpc_target(address)
    check_security(security, address)
    credentials = credentials_of(security)
    if credentials is None:
        return module.insecure_channel(target, options=_ARGUMENTS)
    return module.secure_channel(target, credentials, options=_ARGUMENTS)
