"""python3 -m ballpiston.command VERB FILE [WORD ...]: the parts of the command line in Python.

    export OUT [JOB ... | KEY=VALUE ...]    writes the estimates of jobs
    sample OUT SPECIFICATION                writes the collisions of a point's samples
    arrays FILE                             replaces a saved result by its arrays (--save NAME.npz)

OUT ends with .csv, .npz or .parquet. The command line starts this program after it has checked the
file and the Python modules that the file needs.
"""

import errno
import json
import os
import re
import signal
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from ballpiston import errors
from ballpiston.client import connect
from ballpiston.estimates_table import estimates_table
from ballpiston.result import load
from ballpiston.table import npz_of, write_table

# The exit codes of the program ballpiston; the first class that an error belongs to counts. The
# exit code of all other errors is 2.
_EXIT_CODES: list[tuple[type[BaseException], int]] = [
    (errors.InvalidArgument, 2),
    (errors.Unavailable, 3),
    (errors.NotFound, 5),
    (errors.PermissionDenied, 6),
    (errors.Unauthenticated, 6),
    (errors.Error, 4),
    (KeyboardInterrupt, 130),
]


def run_program(main: Callable[[list[str]], Iterable[Path]], arguments: list[str]) -> int:
    """Prints the paths of the files that `main` writes. Returns the exit code."""
    try:
        # Until here SIGTERM ends Python in silence, and SIGINT would print a traceback.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        for path in main(arguments):
            _print_name(path)
    except BrokenPipeError:  # the reader has ended
        return 0
    except (errors.Error, KeyboardInterrupt, OSError, ValueError, MemoryError, TypeError) as error:
        if not isinstance(error, KeyboardInterrupt):
            print(f"ballpiston: {_with_flags(error)}", file=sys.stderr)
        return exit_code_of(error)
    return 0


def _print_name(path: Path) -> None:
    """As bytes, because the encoding of standard output may lack a character."""
    if sys.stdout is None:  # it was closed at the start
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))
    try:
        sys.stdout.buffer.write(os.fsencode(path) + b"\n")
        sys.stdout.buffer.flush()
    except OSError:
        # Else Python flushes it again at its end, and exits with 120.
        sys.stdout = None  # type: ignore[assignment]
        raise


def exit_code_of(error: BaseException) -> int:
    """That of the program ballpiston for the same error."""
    if isinstance(error, errors.NoPrivateServer) and error.exit_code:
        return error.exit_code
    if isinstance(error, errors.ResourceExhausted) and error.reason:
        return 3 if error.retry_delay else 2  # the server names a delay if a retry can help
    return next((code for kind, code in _EXIT_CODES if isinstance(error, kind)), 2)


def _with_flags(error: BaseException) -> str:
    """The message, with flags in place of the specification's fields: --rho for spec.grid.rho[0]."""
    message = str(error)
    if isinstance(error, OSError) and error.strerror:
        message = ": ".join(filter(None, [error.filename, error.strerror]))
    for field, _ in getattr(error, "violations", []):
        flag = re.sub(r"\[\d+\]$", "", field).rpartition(".")[2].replace("_", "-")
        message = message.replace(f"{field}:", f"--{flag}:")
    return message


def _export(out: Path, *words: str) -> list[Path]:
    labels = dict(word.split("=", 1) for word in words if "=" in word)
    with connect() as client:
        named = [client.job(word) for word in words if "=" not in word]
        jobs = named or client.jobs(labels=labels, limit=None)
        if labels and not jobs:
            raise errors.NotFound(f"--label {' --label '.join(words)}: no job has these labels")
        write_table(out, estimates_table(jobs))
    return [out]


def _sample(out: Path, specification: str) -> list[Path]:
    with connect() as client:
        records = client.sample(json.loads(specification)).all()
    table = {name: records[name] for name in records.dtype.names or ()}
    write_table(out, table, compressed=False)  # random digits do not become smaller
    return [out]


def _arrays(file: Path) -> list[Path]:
    file.write_bytes(npz_of(load(file).arrays()))
    return []  # the client prints the final name


def _main(arguments: list[str]) -> list[Path]:
    verb, file, *words = arguments
    verbs: dict[str, Callable[..., list[Path]]]
    verbs = {"export": _export, "sample": _sample, "arrays": _arrays}
    return verbs[verb](Path(file), *words)


if __name__ == "__main__":
    sys.exit(run_program(_main, sys.argv[1:]))
