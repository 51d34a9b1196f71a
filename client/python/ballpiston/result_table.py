"""A result as a table, one row a point, for terminals and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from ballpiston.number_text import measured_text
from ballpiston.point import parameters_of
from ballpiston.spelling import spelling
from ballpiston.v1 import spec_pb2

_MOST_ROWS = 20

Row = dict[str, str]


def text_table(heading: str, points: Sequence[Any]) -> str:
    """The heading, then aligned columns."""
    rows = [_row(point) for point in points[:_MOST_ROWS]]
    titles = _titles(rows)
    lines = [titles] + [[row.get(title, "") for title in titles] for row in rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(titles))]
    text = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths)) for line in lines]
    return "\n".join([heading, *(text if rows else []), *_ending(points)])


def html_table(heading: str, points: Sequence[Any]) -> str:
    """The same as HTML. Everything that comes from the server is escaped."""
    rows = [_row(point) for point in points[:_MOST_ROWS]]
    titles = _titles(rows)
    head = "".join(f"<th>{escape(title)}</th>" for title in titles)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(row.get(title, ''))}</td>" for title in titles) + "</tr>"
        for row in rows
    )
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>" if rows else ""
    ending = "".join(f"<p>{escape(line)}</p>" for line in _ending(points))
    return f"<p>{escape(heading)}</p>{table}{ending}"


def _row(point: Any) -> Row:
    row = {
        name: value if isinstance(value, str) else f"{value:.6g}"
        for name, value in parameters_of(point).items()
    }
    row["model"] = spelling(spec_pb2.EnsembleSpec.Model, point.model)
    row["samples"] = f"{point.samples:.15g}"
    for estimate in point.estimates:
        error = estimate.standard_error if estimate.HasField("standard_error") else None
        row[estimate.name] = measured_text(estimate.value, error)
        if estimate.HasField("z_score"):
            row[estimate.name] += f" (z {estimate.z_score:+.2f})"
    return row


def _titles(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(title for row in rows for title in row))


def _ending(points: Sequence[Any]) -> list[str]:
    more = [f"and {len(points) - _MOST_ROWS} more points"] if len(points) > _MOST_ROWS else []
    remarks = dict.fromkeys(remark for point in points for remark in point.remarks)
    return more + [f"remark: {remark}" for remark in remarks]
