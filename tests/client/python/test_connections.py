"""Addresses, TLS, tokens and settings."""

from __future__ import annotations

import os
import pwd
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import grpc
import pytest
from conftest import LIMIT, Home, wait_until

import ballpiston
from ballpiston._google_rpc import error_details_pb2, status_pb2
from ballpiston.channel_security import ChannelSecurity, Token, check_security, user_folder
from ballpiston.connection import Connection, connection_hint
from ballpiston.errors import facts_of, from_rpc_error, text_of
from ballpiston.private_server import find_program
from ballpiston.server_address import grpc_target, literal_address
from ballpiston.settings import address_and_security


def private(folder: Path, name: str, text: str, mode: int = 0o600) -> str:
    path = folder / name
    path.write_text(text)
    path.chmod(mode)
    return str(path)


def test_an_address_is_a_host_with_a_port_or_a_socket() -> None:
    for address in ("localhost:50051", "[::1]:50051"):
        assert grpc_target(address) == f"dns:///{address}"
    assert grpc_target("unix:" + "x" * 100) == "unix:" + "x" * 100
    with pytest.raises(ValueError, match="more than 100 bytes"):
        grpc_target("unix:" + "x" * 101)


NOT_ADDRESSES = ["a b:1", *"localhost :1 ::1:50051 host:0 host:65536 host:x unix: unix:a#".split()]


@pytest.mark.parametrize(
    ("address", "keywords", "message"),
    [
        *((address, {}, "write host:port, .* or unix:PATH") for address in NOT_ADDRESSES),
        *(("host:1", {"timeout": t}, "^timeout ") for t in (0, -3, float("nan"))),
        ("unix:/run/socket", {"tls": True}, "a Unix socket uses no TLS"),
        (None, {"ca": "ca.pem"}, "the private server needs no ca"),
        ("host:1", {"ca": "missing.pem"}, "authority file missing.pem cannot be read"),
        ("host:1", {"ca": "0"}, "PEM"),
        *(
            ("host:1", {"tls": True, "token_file": str(n)}, "one word of 1 to 256")
            for n in range(4)
        ),
    ],
)
def test_wrong_arguments_of_connect_are_named(
    address: str | None,
    keywords: Any,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    for number, text in enumerate(["", "two words", "x" * 257, "ä"]):
        private(tmp_path, str(number), text)
    with pytest.raises(ValueError, match=message):
        ballpiston.connect(address, **keywords)


def test_calls_may_take_any_time() -> None:
    with pytest.raises(TypeError, match="^timeout "):
        ballpiston.connect(timeout="3")  # type: ignore[arg-type]
    with ballpiston.connect(timeout=float("inf")) as client:
        assert client.jobs(limit=1) is not None


def test_a_token_needs_tls_or_a_loopback_address() -> None:
    for address in ("host:1", "192.168.0.7:1", "localhost.host:1"):
        with pytest.raises(ValueError, match="use TLS"):
            check_security(ChannelSecurity(token="secret"), address)
        check_security(ChannelSecurity(token="secret", tls=True), address)
    for address in ("127.0.0.1:1", "[::1]:1", literal_address("localhost:1")):
        check_security(ChannelSecurity(token="secret"), address)


def test_a_token_file_that_others_can_read_is_rejected(tmp_path: Path) -> None:
    open_file = private(tmp_path, "token", "secret\n", 0o640)
    with pytest.raises(ballpiston.PermissionDenied, match="mode 0640.*chmod 600") as caught:
        ballpiston.connect("host:1", tls=True, token_file=open_file)
    assert "secret" not in str(caught.value)
    os.chmod(open_file, 0o600)
    ballpiston.connect("host:1", tls=True, token_file=open_file).close()


def test_a_token_file_is_read_once_for_a_connection(tmp_path: Path) -> None:
    file = private(tmp_path, "token", "secret\n")
    token = Token(ChannelSecurity(token_file=file), "127.0.0.1:1")
    os.remove(file)
    assert token.metadata() == [("authorization", "Bearer secret")]
    assert Token(ChannelSecurity(token="secret", tls=True), "h:1").metadata() == token.metadata()
    assert Token(ChannelSecurity(), "host:1").metadata() == []


def test_the_servers_own_token_is_read_for_each_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    folder = tmp_path / "ballpiston" / "tokens" / socket.gethostname()
    folder.mkdir(parents=True)
    token = Token(ChannelSecurity(), "127.0.0.1:1")
    assert token.metadata() == []
    for text in ("first", "second"):
        private(folder, "127.0.0.1:1", text + "\n")
        assert token.metadata() == [("authorization", f"Bearer {text}")]
    assert "Bearer t" in Token(ChannelSecurity(token="t"), "127.0.0.1:1").metadata()[0]
    private(folder, "host:1", "third\n")
    assert Token(ChannelSecurity(), "host:1").metadata() == []
    assert Token(ChannelSecurity(tls=True), "127.0.0.1:1").metadata() == []


@pytest.mark.parametrize("metadata_of", [lambda *pairs: pairs, grpc.aio.Metadata])
def test_an_error_has_the_details_of_its_status(metadata_of: Any) -> None:
    status = status_pb2.Status()
    retry = error_details_pb2.RetryInfo()
    retry.retry_delay.FromMilliseconds(1500)
    status.details.add().Pack(retry)
    status.details.add().Pack(error_details_pb2.ErrorInfo(reason="RESULTS_EXPIRED"))
    failed = SimpleNamespace(
        code=lambda: grpc.StatusCode.FAILED_PRECONDITION,
        details=lambda: "gone",
        trailing_metadata=lambda: metadata_of(
            ("grpc-retry-pushback-ms", "1500"),
            ("grpc-status-details-bin", status.SerializeToString()),
        ),
    )
    error = from_rpc_error(failed)
    assert isinstance(error, ballpiston.ResultsExpired)
    assert (str(error), error.retry_delay) == ("gone (RESULTS_EXPIRED)", 1.5)
    connection: Any = SimpleNamespace(_repeated=MagicMock(side_effect=error))
    with pytest.raises(ballpiston.ResultsExpired, match=r"\)\nTo compute them again: client.run"):
        Connection.call(connection, None)
    assert str(ballpiston.Error("its text", reason=error.reason)) == "its text"
    assert ballpiston.Error("", **facts_of(status_pb2.Status())).retry_delay == 0
    # Violations that were left out are counted if the metadata have a number.
    for stated, text in (("2", "not valid, 2 violations:\n  and 2 more"), ("many", "wrong")):
        assert text_of("wrong", {"metadata": {"violations_left_out": stated}}) == text


def test_an_argument_wins_over_the_environment_and_that_over_the_config_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = (
        'server = "config:1"\nca = "config.pem"\ntoken-file = "config.token"\n[run]\nseed = 3\n'
    )
    monkeypatch.setenv("BALLPISTON_CONFIG", private(tmp_path, "config.toml", config))
    address, security = address_and_security({})
    assert (address, security.ca, security.token_file) == ("config:1", "config.pem", "config.token")
    monkeypatch.setenv("BALLPISTON_SERVER", "environment:1")
    monkeypatch.setenv("BALLPISTON_CA", "environment.pem")
    monkeypatch.setenv("BALLPISTON_TLS", "1")
    monkeypatch.setenv("BALLPISTON_TOKEN", "secret")
    security = address_and_security({})[1]
    assert (security.token, security.token_file) == ("secret", "")
    address, security = address_and_security({"ca": "argument.pem", "token_file": "argument.token"})
    assert (address, security.ca, security.tls) == ("environment:1", "argument.pem", True)
    assert (security.token_file, security.token) == ("argument.token", "")
    assert "secret" not in repr(address_and_security({})[1])
    # Over a Unix socket the variables and the config file mean nothing.
    assert address_and_security({"address": "unix:/s"}) == ("unix:/s", ChannelSecurity())


def test_a_wrong_setting_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BALLPISTON_SERVER", "host:1")
    monkeypatch.setenv("BALLPISTON_TLS", "perhaps")
    with pytest.raises(ValueError, match="tls is 'perhaps'"):
        ballpiston.connect()
    monkeypatch.setenv("BALLPISTON_CONFIG", private(tmp_path, "config.toml", "server = "))
    with pytest.raises(ValueError, match="config.toml cannot be used"):
        ballpiston.connect()


@pytest.mark.parametrize("home", ["", "relative"])
def test_a_relative_home_is_replaced_by_the_users_entry(
    home: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", home)
    own = Path(pwd.getpwuid(os.getuid()).pw_dir)
    assert user_folder("NONE", ".config") == own / ".config" / "ballpiston"


@pytest.mark.parametrize(
    "function,error", [("pwd.getpwuid", KeyError), ("pathlib.Path.exists", PermissionError)]
)
def test_a_home_folder_that_cannot_be_read_has_no_settings(
    function: str, error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    for variable in ("HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(variable)
    monkeypatch.setattr(function, fail)
    assert address_and_security({"address": "host:1"}) == ("host:1", ChannelSecurity())
    assert Token(ChannelSecurity(), "127.0.0.1:1").metadata() == []


def test_a_program_that_is_missing_or_cannot_be_started_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("BALLPISTON_PROGRAM")
    monkeypatch.setattr("ballpiston.private_server.__file__", str(tmp_path / "1/2/3/4/5"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ballpiston.NoPrivateServer, match="install the package ballpiston"):
        find_program()
    (tmp_path / "ballpiston").touch(0o700)
    assert find_program() == str(tmp_path / "ballpiston")
    for prefix in (tmp_path, tmp_path / "1/2"):  # the latter is nearer to the package
        program = prefix / "bin" / "ballpiston"
        program.parent.mkdir(parents=True)
        program.touch(0o700)
        assert find_program() == str(program)
    monkeypatch.setenv("BALLPISTON_PROGRAM", str(tmp_path / "missing"))
    with pytest.raises(ballpiston.NoPrivateServer, match="cannot start .*missing"):
        ballpiston.connect()


def test_the_private_servers_address_is_utf_8_in_every_locale(home: Home, tmp_path: Path) -> None:
    script = tmp_path / "ballpiston"
    script.write_bytes("#!/bin/sh\necho unix:/ü/s\n".encode())
    script.chmod(0o700)
    program = (
        "import sys; from ballpiston.private_server import private_address\n"
        "print(ascii(private_address(sys.argv[1])))"
    )
    ascii_only = os.environ | {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    reader = home.python(program, str(script), env=ascii_only)
    assert reader.communicate(timeout=LIMIT) == ("'unix:/\\xfc/s'\n", "")


def test_hints_say_what_a_user_can_do() -> None:
    tls = ChannelSecurity(ca="ca.pem")
    assert "in ca.pem" in connection_hint("host:1", tls, "certificate verify failed")
    assert "does not use TLS" in connection_hint("host:1", tls, "wrong version number")
    assert "ca=FILE" in connection_hint("host:1", ChannelSecurity(), "Socket closed")
    assert "only its own user" in connection_hint("unix:/s", ChannelSecurity(), "Permission denied")
    assert connection_hint("host:1", ChannelSecurity(), "connection refused") == ""


@contextmanager
def serving(home: Home, folder: Path, flags: str) -> Iterator[str]:
    """The address of a server; the file ada.token has a token for it."""
    program = str(home.programs / "ballpistond")
    token = subprocess.run(
        [program, "--access-file", "access", "--new-token", "ada:submit"],
        cwd=folder,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    ).stdout
    private(folder, "ada.token", token)
    always = "--listen 127.0.0.1:0 --data-dir data --access-file access"
    server = subprocess.Popen(
        [program, *always.split(), *flags.split()], cwd=folder, stderr=subprocess.DEVNULL
    )
    written = folder / "data" / "server.address"
    try:
        wait_until(lambda: written.exists() and written.read_text().endswith("\n"))
        yield written.read_text().strip().replace("127.0.0.1", "localhost")
    finally:
        server.terminate()
        server.wait()


def test_on_the_loopback_only_the_servers_user_needs_no_token(
    home: Home, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with serving(home, tmp_path, "") as address:
        with ballpiston.connect(address, timeout=LIMIT) as client:
            assert client.status().principal == "local"
        monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))  # as another user
        with ballpiston.connect(address, timeout=LIMIT) as client:
            with pytest.raises(ballpiston.Unauthenticated) as caught:
                client.status()
            assert caught.value.reason == "CREDENTIALS_MISSING"


def test_tls_and_a_token_reach_a_server_that_wants_them(home: Home, tmp_path: Path) -> None:
    # The certificate is its own authority.
    openssl = (
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 "
        "-subj /CN=localhost -addext subjectAltName=DNS:localhost "
        "-keyout server.key -out server.pem"
    )
    subprocess.run(openssl.split(), cwd=tmp_path, check=True, stderr=subprocess.DEVNULL)
    (tmp_path / "server.key").chmod(0o600)
    ca, token_file = str(tmp_path / "server.pem"), str(tmp_path / "ada.token")
    with serving(home, tmp_path, "--tls-certificate server.pem --tls-key server.key") as address:
        with ballpiston.connect(address, ca=ca, token_file=token_file, timeout=LIMIT) as client:
            status = client.status()
            assert (status.principal, status.role) == ("ada", "submit")
        with ballpiston.connect(address, tls=True, timeout=LIMIT) as client:
            with pytest.raises(ballpiston.Unavailable, match="ca=FILE"):
                client.status()
