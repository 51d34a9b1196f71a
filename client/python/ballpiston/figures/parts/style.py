"""The style of all pictures, and what most of them draw."""

import functools
import io
import string
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.style
import numpy as np
from matplotlib.axes import Axes as Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_hex
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from ballpiston.figures.parts.tables import Table, Tables, groups
from ballpiston.whole_file import write_atomically

BLUE, ORANGE, GREEN, PINK = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
BLACK, GREY, EDGE = "#202020", "#808080", "#8c8c8c"
DISC, REACH, OVERLAP = "#dcdcdc", "#e3ecfb", "#c8c8c8"  # of the cell
# From slow to fast; it grows lighter, so it can also be read without colours.
ENERGY = LinearSegmentedColormap.from_list(
    "energy", ["#2b3a9e", "#6a5acd", "#c4243a", "#f28a1c", "#f5d000"]
)

# Options of `panels`: the panels of a row have one vertical axis, all have one horizontal axis.
SHARED: dict[str, Any] = {"sharex": True, "sharey": "row", "squeeze": False}

_PIXELS = 100.0  # of an inch; sizes of pictures are in pixels
_SHEET = Path(__file__).with_name("ballpiston.mplstyle")


def styled(draw: Callable[[Tables], Figure]) -> Callable[[Tables], Figure]:
    """Lets a function draw in the style of all pictures, without the user's matplotlibrc."""

    @functools.wraps(draw)
    def in_style(tables: Tables) -> Figure:
        with matplotlib.style.context(_SHEET, after_reset=True):
            return draw(tables)

    return in_style


def save(figure: Figure, path: Path) -> None:
    """As SVG or PNG, by the end of the path. The same picture gives the same file. A full disk
    leaves the old file."""
    ending = path.suffix.removeprefix(".")
    buffer = io.BytesIO()  # PNG needs a file that can seek; a pipe cannot
    with matplotlib.style.context(_SHEET, after_reset=True):
        metadata = {"Date": None} if ending == "svg" else {}
        figure.savefig(buffer, format=ending, metadata=metadata)
    write_atomically(path, buffer.getvalue())


def colour(index: int) -> str:
    """Of the line of this number."""
    return str(to_hex(f"C{index}"))


Series = tuple[Table, str, str]  # the rows of one value, with the value's colour and label


def series(whole: Table, name: str, symbol: str) -> list[Series]:
    """One for each value of the column `name`, in the order of their first appearance."""
    in_order = enumerate(groups(whole, name))
    return [(part, colour(k), f"{symbol} = {x:g}") for k, ((x,), part) in in_order]


def picture(width: float, height: float) -> Figure:
    """An empty figure; the size is in pixels."""
    return Figure(figsize=(width / _PIXELS, height / _PIXELS))


def panels(
    size: tuple[float, float], down: int, across: int, titles: Iterable[str] = (), **options: Any
) -> tuple[Figure, Any]:
    """A figure of panels, and the panels. Their titles have the letters a, b, ..."""
    figure = picture(*size)
    matrix = figure.subplots(down, across, **options)
    for axes, letter, text in zip(np.ravel(matrix), string.ascii_lowercase, titles):
        axes.set_title(rf"$\mathbf{{{letter}}}$  {text}")
    return figure, matrix


def bare_axes(figure: Figure, place: Any = 111) -> Any:
    """Axes without a frame, for drawings. Lengths of x and y are equal."""
    axes = figure.add_subplot(place, aspect="equal")
    axes.set_axis_off()
    return axes


def arrows(axes: Any, bodies: Any, unit: float, **style: Any) -> None:
    """The velocities of bodies at their places, where `unit` is that of an arrow of length 1."""
    x, y, vx, vy = (bodies[name] for name in ("x", "y", "vx", "vy"))
    axes.quiver(x, y, vx, vy, angles="xy", scale_units="xy", scale=unit, **style)


def axis_arrows(axes: Any, origin: Sequence[float], length: float, names: Sequence[str]) -> None:
    """The directions of a drawing in three dimensions."""
    for k, name in enumerate(names):
        step = length * np.eye(3)[k]
        axes.quiver(*origin, *step, color=BLACK, arrow_length_ratio=0.25, zorder=9)
        axes.text(*(origin + 1.3 * step), name, ha="center", va="center")


def error_points(
    axes: Axes, x: Any, y: Any, error: Any, color: str, label: str = "", **more: Any
) -> None:
    """Points with one standard error. A point whose error is not known is hollow."""
    style = {"fmt": "o", "elinewidth": 1.1, "color": color} | more
    known = np.isfinite(error)
    line = axes.errorbar(x, y, yerr=np.where(known, error, 0.0), label=label or None, **style)[0]
    if not known.all():
        hollow = {"color": color, "markerfacecolor": "white", "zorder": line.get_zorder()}
        hollow["markersize"] = line.get_markersize()
        axes.plot(np.asarray(x)[~known], np.asarray(y)[~known], line.get_marker(), **hollow)


def level(axes: Axes, y: float, **style: Any) -> None:
    """A horizontal line over the whole panel, behind the points."""
    axes.axhline(y, **({"color": BLACK, "linewidth": 1.0, "zorder": 1} | style))


def point_handle(label: str, color: str, marker: str = "o", **style: Any) -> Line2D:
    """An entry of a legend: points."""
    return Line2D([], [], linestyle="", marker=marker, color=color, label=label, **style)


def inside(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    """A text in a panel; x and y are shares of its width and height."""
    axes.text(x, y, text, transform=axes.transAxes, **style)


def top_legend(figure: Figure, handles: Sequence[Any], columns: int = 0, **more: Any) -> None:
    """One legend for all panels, in a strip of its own above them."""
    columns = columns or len(handles)
    lines = -(-len(handles) // columns)
    height = (14 + 22 * lines) / _PIXELS / figure.get_figheight()
    figure.legend(handles=handles, loc="upper center", ncol=columns, frameon=False, **more)
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - height))


def remove_empty(panels: Any, count: int) -> None:
    """Removes all panels but the first `count`; the panels above them get numbers at their axes."""
    for axes in panels.flat[count:]:
        axes.remove()
    for axes in panels[-2:-1].flat[count - panels.size :] if count < panels.size else ():
        axes.tick_params(labelbottom=True)


def widen(axes: Axes, low: float, high: float) -> None:
    """Widens the vertical axis so that it includes this range and all points."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(min(low, bottom), max(high, top))


def signed_log_axis(axes: Axes, noise: float) -> None:
    """A vertical axis that is linear below the power of ten above `noise`, and logarithmic above it,
    on both sides of 0."""
    axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(noise)))


def plain_log_ticks(axis: Any, at: Sequence[float]) -> None:
    """Decimal numbers at a logarithmic axis, instead of powers of ten."""
    axis.set_major_locator(FixedLocator(at))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))


def power_text(x: float) -> str:
    """Of a number with one digit, such as 6×10⁻¹⁵, -10⁻² or 0, as mathematical text."""
    if x == 0:
        return "0"
    digit, exponent = f"{abs(x):.0e}".split("e")
    factor = "" if digit == "1" else rf"{digit}\times "
    return f"${'-' if x < 0 else ''}{factor}10^{{{int(exponent)}}}$"


def energy_bar(figure: Figure, axes: Any, highest: float, label: str, **place: Any) -> Any:
    """A colour bar of energies from 0 to `highest`; returns the scale of the colours."""
    scale = ScalarMappable(Normalize(0, highest), ENERGY)
    figure.colorbar(scale, ax=axes, label=label, **place)
    return scale
