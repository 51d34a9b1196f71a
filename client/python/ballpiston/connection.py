"""The connection of a Client: its channel, and how a call is made. The type of a request names the
call: GetEnsembleJobRequest is the request of GetEnsembleJob.

A private server may stop, idle, just as a call arrives, or be killed: then it is started again and
the call is repeated once. So every call that goes through `call` has to be safe to repeat.
"""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import grpc

from ballpiston.channel import open_channel
from ballpiston.channel_security import ChannelSecurity, Token
from ballpiston.connection_hint import connection_hint
from ballpiston.error_details import from_rpc_error
from ballpiston.errors import Error, Unavailable
from ballpiston.private_server import PrivateServer
from ballpiston.server_address import literal_address
from ballpiston.v1.analytic_pb2_grpc import AnalyticServiceStub
from ballpiston.v1.ensemble_pb2_grpc import EnsembleServiceStub
from ballpiston.v1.server_pb2_grpc import ServerServiceStub
from ballpiston.v1.trace_pb2_grpc import TraceServiceStub

_SERVICES = (AnalyticServiceStub, EnsembleServiceStub, ServerServiceStub, TraceServiceStub)
_REVIVE_SECONDS = 10.0


class Connection:
    """A channel to the server at `address`. `private`: the server is the user's private one, and
    may be started again. `timeout` bounds each single call, in seconds. Safe to share between
    threads.
    """

    def __init__(
        self,
        address: str,
        security: ChannelSecurity,
        *,
        private: PrivateServer | None = None,
        timeout: float = 60.0,
    ) -> None:
        self.address = address if security.has_tls else literal_address(address)
        self.security = security
        self.private = private
        self.timeout = timeout
        self.channel = open_channel(self.address, security)
        self._token = Token(security, self.address)
        # Also at the interpreter's exit: gRPC's own destructor comes after its threads were killed,
        # and would wait forever for a lock that one of them held.
        self.close = weakref.finalize(self, self.channel.close)
        self._methods: dict[str, Callable[..., Any]] = {}
        for service in _SERVICES:
            self._methods |= vars(service(self.channel))

    def call(self, request: Any) -> Any:
        """The answer to a call that may be repeated."""
        try:
            return self.call_once(request)
        except Unavailable as error:
            if self.private is None or error.code != "UNAVAILABLE":
                raise
            time.sleep(error.retry_delay)
        self.revive()
        return self.call_once(request)

    def call_once(self, request: Any, timeout: float | None = None) -> Any:
        """The answer to a single attempt, apart from those of the channel's retry policy."""
        try:
            seconds = self.timeout if timeout is None else timeout
            return self._method_of(request)(request, timeout=seconds, metadata=self.metadata())
        except grpc.RpcError as error:
            raise self.error_of(error) from None

    def open_stream(self, request: Any) -> Any:
        """The messages of a streaming call. From the main thread the call begins on a thread of its
        own, which Ctrl-C does not interrupt: a call that is interrupted while it begins is never
        read by gRPC, and the interpreter would wait for it forever at its exit."""
        if threading.current_thread() is not threading.main_thread():  # it may outlive the main one
            return self._method_of(request)(request, metadata=self.metadata())
        with ThreadPoolExecutor(max_workers=1) as thread:
            begun = thread.submit(self._method_of(request), request, metadata=self.metadata())
            try:
                return begun.result()
            except KeyboardInterrupt:
                begun.result().cancel()
                raise

    def metadata(self) -> list[tuple[str, str]]:
        """The metadata of a call: the token, if one is to be sent."""
        return self._token.metadata()

    def error_of(self, rpc_error: grpc.RpcError) -> Error:
        """The exception for a failed call. An error without a reason is one of the connection: its
        text names the server."""
        error = from_rpc_error(rpc_error)
        if not isinstance(error, Unavailable) or error.reason:
            return error
        message = str(error)
        hint = connection_hint(self.address, self.security, message)
        text = f"no answer from the server at {self.address}: {message}{hint}"
        return type(error)(text, code=error.code)

    def revive(self, wait: float = _REVIVE_SECONDS) -> None:
        """Starts a private server again if it is gone. Then waits, at most `wait` seconds, until
        the channel is connected: it may be pausing after its last attempt, and a call would fail at
        once.

        Raises:
            NoPrivateServer: the private server cannot be started.
        """
        if self.private is not None:
            self.private.address()
        ready = grpc.channel_ready_future(self.channel)
        try:
            ready.result(timeout=wait)
        except grpc.FutureTimeoutError:
            pass
        finally:
            ready.cancel()

    def _method_of(self, request: Any) -> Callable[..., Any]:
        return self._methods[type(request).__name__.removesuffix("Request")]
