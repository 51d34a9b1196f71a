"""Files that are written as a whole or not at all."""

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def write_atomically(path: Path, data: bytes) -> None:
    """The whole file or none."""
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file beside `path` to write to. It becomes `path` at the end, and is removed after an
    error, so that no half-written result remains. A pipe or a device is written to directly."""
    target = path.resolve()  # symbolic links stay
    umask = os.umask(0o077)
    os.umask(umask)
    try:
        if path.exists() and not path.is_file():
            yield path
            return
        mode = target.stat().st_mode if target.exists() else 0o666 & ~umask
        descriptor, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        os.close(descriptor)
        temporary = Path(name)
        try:
            yield temporary
            temporary.chmod(stat.S_IMODE(mode))  # mkstemp's files are private
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        if error.strerror:  # errors of writes name no file, others the temporary one
            error.filename = str(path)
        raise
