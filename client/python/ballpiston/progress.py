"""The progress bar of a watch, on standard error or in a notebook.

tqdm draws it if tqdm is installed. Where nobody looks, in a pipeline for instance, there is no bar.
"""

import json
import os
import sys
import warnings
from typing import Any

from ballpiston.fields import json_of
from ballpiston.point import Point
from ballpiston.v1 import ensemble_pb2

_BAR_WIDTH = 20


class Progress:
    """Follows a watch, and shows nothing."""

    def __init__(self) -> None:
        self._fraction = 0.0
        self._text = ""  # such as "1/4 points"

    def show(self, message: Any) -> None:
        """Shows a message of a watch."""
        progress = progress_in(message)
        if progress is None:
            return
        points = list(message.snapshot.points) or list(message.snapshot.finished_points)[-1:]
        self._fraction = fraction_of(progress)
        self._text = f"{progress.points_done}/{progress.points} points"
        first = next(iter(Point(points[0]).estimates.values()), None) if points else None
        self.draw(self._fraction, self._text if first is None else f"{self._text}  {first}")

    def show_pause(self, is_busy: bool, pause: float) -> None:
        """Shows that the stream broke and that the next stream begins after `pause` seconds."""
        why = "server busy" if is_busy else "no answer"
        self.draw(self._fraction, f"{self._text}  {why}, retrying in {pause:.1f} s")

    def draw(self, fraction: float, text: str) -> None:
        """Draws the bar, in place of the last one."""

    def note(self, text: str) -> None:
        """Writes a line of its own, above the bar."""

    def close(self) -> None:
        """Ends the line of the bar."""


class Bar(Progress):
    """A line on standard error that every update overwrites."""

    def __init__(self) -> None:
        super().__init__()
        self._width = 0

    def draw(self, fraction: float, text: str) -> None:
        marks = int(min(max(fraction, 0.0), 1.0) * _BAR_WIDTH)
        room = _columns() - 1  # a longer line would wrap
        line = f"[{'#' * marks}{'-' * (_BAR_WIDTH - marks)}] {text}"[:room]
        sys.stderr.write("\r" + line.ljust(self._width)[:room])
        sys.stderr.flush()
        self._width = len(line)

    def note(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width) + "\n")

    def close(self) -> None:
        if self._width > 0:
            sys.stderr.write("\n")


def _columns() -> int:
    """Of the terminal at standard error."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (OSError, ValueError):  # no terminal, or no file
        return 80


class _TqdmBar(Progress):
    def __init__(self, tqdm: Any) -> None:
        super().__init__()
        self._tqdm = tqdm
        self._bar: Any = None

    def draw(self, fraction: float, text: str) -> None:
        if self._bar is None:
            shape = "{percentage:3.0f}%|{bar}| {desc} [{elapsed}<{remaining}]"
            # `initial`: tqdm computes the time left from the progress during this watch only.
            self._bar = self._tqdm(total=1.0, initial=fraction, bar_format=shape, file=sys.stderr)
        if fraction <= self._bar.initial:  # no work yet: the time in the queue does not count
            self._bar.initial = fraction
            self._bar.unpause()
        self._bar.n = fraction
        self._bar.set_description_str(text, refresh=False)
        self._bar.refresh()

    def note(self, text: str) -> None:
        self._tqdm.write(text, file=sys.stderr)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


class JsonLines(Progress):
    """Writes each message as one line of JSON to standard error, for programs."""

    def __init__(self) -> None:
        super().__init__()
        self._job: dict[str, Any] = {}

    def show(self, message: Any) -> None:
        if message.HasField("job"):
            state = ensemble_pb2.EnsembleJob.State.Name(message.job.state)
            self._job = {"job": message.job.name, "state": state}
        if (progress := progress_in(message)) is not None:
            line = self._job | {"progress": json_of(progress)}
            print(json.dumps(line), file=sys.stderr, flush=True)


def progress_on_screen(wanted: bool | str) -> Progress:
    """True or "auto": with a bar if somebody looks, in a terminal or in a notebook; "bar": with a
    bar; "json": lines of JSON; False or "none": nothing. Raises ValueError: another text."""
    if wanted not in (True, False, "auto", "bar", "json", "none"):
        raise ValueError(f"progress is {wanted!r}; permitted: auto, bar, json, none")
    if wanted == "json":
        return JsonLines()
    is_seen = wanted in (True, "auto") and (has_terminal() or _is_notebook())
    return _new_bar() if is_seen or wanted == "bar" else Progress()


def has_terminal() -> bool:
    """Whether standard error is a terminal. It is None where it was closed at the start."""
    return sys.stderr is not None and sys.stderr.isatty()


def progress_in(message: Any) -> Any | None:
    """The JobProgress in a message of a watch; None in a heartbeat."""
    update = message.WhichOneof("update")
    return getattr(message, update).progress if update in ("job", "snapshot") else None


def fraction_of(progress: Any) -> float:
    """The share of the work that is done: the server's prediction, else that of the points."""
    if progress.HasField("fraction"):
        return float(progress.fraction)
    return float(progress.points_done / progress.points) if progress.points else 0.0


def _is_notebook() -> bool:
    """Only a kernel of Jupyter has loaded ipykernel and runs a shell of its own."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and hasattr(shell, "kernel")


def _new_bar() -> Progress:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # tqdm warns if a notebook has no widgets
            from tqdm.auto import tqdm
    except ImportError:
        return Bar()
    return _TqdmBar(tqdm)
