"""Which server, and how: the argument of `connect`, else the environment variable, else the config
file of the command line, ~/.config/ballpiston/config.toml."""

import os
import pwd
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ballpiston.channel_security import ChannelSecurity
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
    for stronger in (_config_file(), _environment(), given):
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


def home_folder() -> Path:
    """HOME if it is absolute, else the user's entry. Raises RuntimeError: there is no entry."""
    home = os.environ.get("HOME", "")
    try:
        return Path(home if home.startswith("/") else pwd.getpwuid(os.getuid()).pw_dir)
    except KeyError:
        raise RuntimeError("no home folder") from None


def _environment() -> dict[str, str]:
    values = {name: os.environ.get(variable, "") for name, variable, _ in _SETTINGS}
    return {name: value for name, value in values.items() if value}


def _config_file() -> dict[str, Any]:
    path = _config_path()
    if path is None:
        return {}
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"the config file {path} cannot be used: {error}") from error
    return {name: content[key] for name, _, key in _SETTINGS if content.get(key)}


def _config_path() -> Path | None:
    if named := os.environ.get("BALLPISTON_CONFIG"):
        return Path(named)
    folder = os.environ.get("XDG_CONFIG_HOME", "")
    try:
        root = Path(folder) if folder.startswith("/") else home_folder() / ".config"
        path = root / "ballpiston" / "config.toml"
        return path if path.exists() else None
    except (OSError, RuntimeError):  # a folder of another user, or no home folder
        return None


def _truth(value: object) -> bool:
    text = str(value).lower()
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    raise ValueError(f"tls is {value!r}; it has to be true or false")
