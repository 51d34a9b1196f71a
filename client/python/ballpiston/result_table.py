"""Tables for terminals and notebooks: a result with one row for each point, and rows of any kind as
HTML."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from ballpiston.point import Point, measured_text

_MOST_ROWS = 20
_LOST = "orbits left the cell; this is a defect: do not use the point"


def result_text(heading: str, points: Sequence[Any]) -> str:
    """The heading, then aligned columns."""
    lines = _lines(points)
    widths = [max(map(len, column)) for column in zip(*lines)]
    text = ["  ".join(map(str.rjust, line, widths)) for line in lines]
    return "\n".join([heading, *text, *_ending(points)])


def result_html(heading: str, points: Sequence[Any]) -> str:
    """The heading and the columns as HTML."""
    titles, *rows = _lines(points) or [[]]
    ending = "".join(f"<p>{escape(line)}</p>" for line in _ending(points))
    return html_table(heading, titles, rows) + ending


def html_table(heading: str, titles: Iterable[str], rows: Sequence[Iterable[str]]) -> str:
    """Heading and rows as HTML. Every text is escaped."""

    def line(tag: str, texts: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts) + "</tr>"

    body = "".join(line("td", row) for row in rows)
    head = line("th", titles)
    table = f"<table><thead>{head}</thead><tbody>{body}</tbody></table>" if rows else ""
    return f"<p>{escape(heading)}</p>{table}"


def _row(message: Any) -> dict[str, str]:
    point = Point(message)
    row = {k: v if isinstance(v, str) else f"{v:.6g}" for k, v in point.parameters.items()}
    row["model"] = point.model
    row["samples"] = f"{point.samples:.15g}"
    for estimate in point.estimates.values():
        row[estimate.name] = measured_text(estimate.value, estimate.standard_error)
        if estimate.z_score is not None:
            row[estimate.name] += f" (z {estimate.z_score:+.2f})"
    return row


def _lines(points: Sequence[Any]) -> list[list[str]]:
    """The titles, then a line for each of the first points; nothing without a point."""
    rows = [_row(point) for point in points[:_MOST_ROWS]]
    titles = list(dict.fromkeys(title for row in rows for title in row))
    lines = [[row.get(title, "") for title in titles] for row in rows]
    return [titles, *lines] if lines else []


def _ending(points: Sequence[Any]) -> list[str]:
    more = [f"and {len(points) - _MOST_ROWS} more points"] if len(points) > _MOST_ROWS else []
    remarks = dict.fromkeys(remark for point in points for remark in point.remarks)
    warnings = warnings_of(points)[:_MOST_ROWS]
    return more + [f"remark: {remark}" for remark in remarks] + warnings


def warnings_of(points: Sequence[Any]) -> list[str]:
    """A sentence for each point whose orbits left the cell."""
    lost = [point for point in points if point.health.escapes]
    return [f"warning: point {point.index}: {point.health.escapes:.15g} {_LOST}" for point in lost]
