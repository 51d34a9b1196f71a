"""What the programs that `ballpiston` starts share: their errors and exit codes."""

from __future__ import annotations

import re
import signal
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from ballpiston import errors

# The exit codes of the program ballpiston; the first class that an error belongs to counts.
_EXIT_CODES: list[tuple[type[BaseException], int]] = [
    (errors.InvalidArgument, 2),
    (errors.Unavailable, 3),
    (errors.NotFound, 5),
    (errors.PermissionDenied, 6),
    (errors.Unauthenticated, 6),
    (errors.Error, 4),
    (KeyboardInterrupt, 130),
    (OSError, 4),
    (ValueError, 2),
    (TypeError, 2),
]


def run_program(main: Callable[[list[str]], Iterable[Path]], arguments: list[str]) -> int:
    """Prints the paths of the files that `main` writes. Returns the exit code."""
    try:
        # Until here SIGTERM ends Python in silence, and SIGINT would print a traceback.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        for path in main(arguments):
            print(path)
    except tuple(kind for kind, _ in _EXIT_CODES) as error:
        if not isinstance(error, KeyboardInterrupt):
            print(f"ballpiston: {_with_flags(error)}", file=sys.stderr)
        return next(code for kind, code in _EXIT_CODES if isinstance(error, kind))
    return 0


def _with_flags(error: BaseException) -> str:
    """The message, with flags in place of the specification's fields: --rho for spec.grid.rho[0]."""
    message = str(error)
    if isinstance(error, OSError) and error.strerror:
        message = ": ".join(filter(None, [error.filename, error.strerror]))
    for field, _ in getattr(error, "violations", []):
        flag = re.sub(r"\[\d+\]$", "", field).rpartition(".")[2].replace("_", "-")
        message = message.replace(f"{field}:", f"--{flag}:")
    return message
