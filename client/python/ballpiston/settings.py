"""Which server, and how: the argument of `connect`, else the environment variable, else the config
file of the command line, ~/.config/ballpiston/config.toml."""

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ballpiston.channel_security import ChannelSecurity, user_folder
from ballpiston.server_address import is_socket

# The argument, the variable, and the key in the config file.
_SETTINGS = (
    ("address", "BALLPISTON_SERVER", "server"),
    ("ca", "BALLPISTON_CA", "ca"),
    ("tls", "BALLPISTON_TLS", "tls"),
    ("token_file", "BALLPISTON_TOKEN_FILE", "token-file"),
    ("token", "BALLPISTON_TOKEN", ""),
)
_TRUE = ("1", "true", "yes", "on", "enable")
_FALSE = ("", "0", "false", "no", "off", "disable")


def address_and_security(given: Mapping[str, Any]) -> tuple[str, ChannelSecurity]:
    """From the arguments of `connect` that are not None. The address is empty for the private
    server. Over a Unix socket, the private server's too, only arguments count. Raises ValueError:
    the private server with TLS or a token, or a config file that is not TOML."""
    settings: dict[str, Any] = {}
    environment = {name: os.environ[v] for name, v, _ in _SETTINGS if os.environ.get(v)}
    for stronger in (_config_file(), environment, given):
        if "token" in stronger or "token_file" in stronger:
            settings.pop("token", None)
            settings.pop("token_file", None)
        settings.update(stronger)
    address = str(settings.pop("address", ""))
    if not address or is_socket(address):
        settings = {name: value for name, value in given.items() if name != "address"}
    if not address and any(settings.values()):
        raise ValueError(
            f"the private server needs no {', '.join(settings)}: name a server, "
            'connect("host:port", ...)'
        )
    settings["tls"] = _truth(settings.get("tls", False))
    return address, ChannelSecurity(**settings)


def _config_file() -> dict[str, Any]:
    named = os.environ.get("BALLPISTON_CONFIG")
    try:
        path = Path(named or user_folder("XDG_CONFIG_HOME", ".config") / "config.toml")
        if not named and not path.exists():
            return {}
    except OSError:  # a folder of another user, or no home folder
        return {}
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"the config file {path} cannot be used: {error}") from error
    return {name: content[key] for name, _, key in _SETTINGS if content.get(key)}


def _truth(value: object) -> bool:
    text = str(value).lower()
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    raise ValueError(f"tls is {value!r}; it has to be true or false")
