"""The connection of a Client: its channel, and how a call is made. The type of a request names the
call: GetEnsembleJobRequest is the request of GetEnsembleJob.

Calls that are safe to repeat are retried for about a second while the server is unreachable: all
but deletions (creations and cancellations carry a request id). If the server says how long to wait
before a retry, gRPC waits so long. Watches attach again by themselves (watch.py).

A private server may stop, idle, just as a call arrives, or be killed: then it is started again and
the call is repeated once. So every call that goes through `call` has to be safe to repeat.
"""

import _thread
import json
import queue
import re
import sys
import threading
import time
import weakref
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from typing import Any

import grpc

from ballpiston._version import __version__
from ballpiston.channel_security import ChannelSecurity, Token, check_security, credentials_of
from ballpiston.errors import Error, ResultsExpired, Unavailable, from_rpc_error
from ballpiston.private_server import private_address
from ballpiston.server_address import grpc_target, is_socket, literal_address
from ballpiston.v1.analytic_pb2_grpc import AnalyticServiceStub
from ballpiston.v1.ensemble_pb2_grpc import EnsembleServiceStub
from ballpiston.v1.server_pb2_grpc import ServerServiceStub
from ballpiston.v1.trace_pb2_grpc import TraceServiceStub

_SERVICES = (AnalyticServiceStub, EnsembleServiceStub, ServerServiceStub, TraceServiceStub)
_REVIVE_SECONDS = 10.0
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


class Connection:
    """A channel to the server at `address`. `private`: the server is the user's private one, and
    the program of this path starts it again. `timeout` bounds each single call, in seconds; None:
    no bound. Safe to share between threads."""

    def __init__(
        self, address: str, security: ChannelSecurity, private: str | None, timeout: float | None
    ) -> None:
        self.address = address if security.has_tls else literal_address(address)
        self.security = security
        self.private = private
        self.timeout = timeout
        self.channel = self.open_channel()
        self.metadata = Token(security, self.address).metadata  # of each call
        # Also at the interpreter's exit: gRPC's own destructor comes after its threads were killed,
        # and would wait forever for a lock that one of them held.
        self.close = weakref.finalize(self, self.channel.close)
        self._methods: dict[str, Any] = {}
        for service in _SERVICES:
            self._methods |= vars(service(self.channel))

    def open_channel(self, module: Any = grpc) -> Any:
        """A grpc.Channel, which does not connect yet. With `module` grpc.aio the channel is for an
        event loop, and only the loop that opened it may use it. Raises ValueError: not an address,
        or security that does not fit together or cannot be read."""
        target = grpc_target(self.address)
        check_security(self.security, self.address)
        credentials = credentials_of(self.security)
        if credentials is None:
            return module.insecure_channel(target, options=_ARGUMENTS)
        return module.secure_channel(target, credentials, options=_ARGUMENTS)

    def call(self, request: Any) -> Any:
        """The answer to a call that may be repeated."""
        try:
            return self._repeated(lambda: self.call_once(request))
        except ResultsExpired as error:
            error.args = (f"{error}\nTo compute them again: client.run(job.specification)",)
            raise

    def pages(self, request: Any) -> Iterator[Any]:
        """The answers to the request for a list and to those for its next pages."""
        while True:
            page = self.call(request)
            yield page
            request.page_token = page.next_page_token
            if not request.page_token:
                return

    def call_once(self, request: Any, timeout: float | None = None) -> Any:
        """The answer to a single attempt, apart from those of the channel's retry policy."""
        options = {"timeout": timeout or self.timeout, "metadata": self.metadata()}
        try:
            return _off_main(self._method_of(request), request, **options)
        except grpc.RpcError as error:
            raise self.error_of(error) from None

    def stream(self, request: Any) -> Generator[Any, None, None]:
        """The messages of a streaming call. It is cancelled when the iterator is closed."""
        call = _off_main(self._method_of(request), request, metadata=self.metadata())
        try:
            while (message := _off_main(next, call, None)) is not None:
                yield message
        except grpc.RpcError as error:
            raise self.error_of(error) from None
        finally:
            _off_main(call.cancel)

    def stream_again(self, request: Any) -> Generator[Any, None, None]:
        """`stream` for a call that may be repeated before its first message arrives; later a
        repetition would begin at the start again."""

        def begun() -> tuple[Any, Generator[Any, None, None]]:
            messages = self.stream(request)
            return next(messages, None), messages

        first, others = self._repeated(begun)
        if first is not None:
            yield first
            yield from others

    def error_of(self, rpc_error: grpc.RpcError) -> Error:
        """The exception for a failed call. An error without a reason is one of the connection: its
        text names the server."""
        error = from_rpc_error(rpc_error)
        if not isinstance(error, Unavailable) or error.reason:
            return error
        message = str(error)
        hint = "" if self.private else connection_hint(self.address, self.security, message)
        text = f"no answer from the server at {self.address}: {message}{hint}"
        return type(error)(text, code=error.code)

    def revive(self, wait: float = _REVIVE_SECONDS) -> None:
        """Starts a private server again if it is gone. Then waits, at most `wait` seconds, until
        the channel is connected: it may be pausing after its last attempt, and a call would fail at
        once. Raises NoPrivateServer: the private server cannot be started."""
        if self.private is not None:
            private_address(self.private)
        _off_main(self._wait_until_connected, wait)

    def _wait_until_connected(self, longest: float) -> None:
        ready = grpc.channel_ready_future(self.channel)
        with suppress(grpc.FutureTimeoutError):
            ready.result(timeout=longest)
        ready.cancel()

    def _repeated(self, attempt: Callable[[], Any]) -> Any:
        """What the attempt returns, or a second one after the private server was started again."""
        try:
            return attempt()
        except Unavailable as error:
            if self.private is None or error.code != "UNAVAILABLE":
                raise
            time.sleep(error.retry_delay)
        self.revive()
        return attempt()

    def _method_of(self, request: Any) -> Any:
        return self._methods[type(request).__name__.removesuffix("Request")]


def connection_hint(address: str, security: ChannelSecurity, message: str) -> str:
    """What to try, on a line of its own, after an error with this text; empty if nothing is known.
    The messages of gRPC 1.51 and OpenSSL 3 do not say what the user can do."""
    kind = "socket" if is_socket(address) else "tls" if security.has_tls else "plain"
    known = f"in {security.ca}" if security.ca else "that this system knows"
    for of, pattern, hint in _HINTS:
        if of == kind and re.search(pattern, message):
            return f"\n  {hint.format(known=known)}"
    return ""


def _off_main(function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    """What the function returns. From the main thread it runs on a thread of its own, which Ctrl-C
    does not interrupt. Interrupted between two of its lines, gRPC may keep a lock for ever, and
    every later call of the channel would wait for it. The main thread waits at a SimpleQueue, which
    an interruption leaves intact. A single call that was interrupted ends by itself."""
    if threading.current_thread() is not threading.main_thread() or sys.is_finalizing():
        return function(*arguments, **options)
    ended: queue.SimpleQueue[tuple[Any, BaseException | None]] = queue.SimpleQueue()

    def run() -> None:
        try:
            ended.put((function(*arguments, **options), None))
        except BaseException as error:
            ended.put((None, error))

    _thread.start_new_thread(run, ())
    value, error = ended.get()
    if error is not None:
        raise error
    return value
