"""What a question would cost with each model, and which model would answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ballpiston.result_table import html_table
from ballpiston.fields import value_of
from ballpiston.spelling import spelled

if TYPE_CHECKING:
    import pandas

_MOST_ROWS = 25


class Plan:
    """The ladder of models for a question. Nothing was run.

    Attributes:
        message: the message ballpiston.v1.PlanEnsembleJobResponse. Of a grid with more than 1,000
            points it has as many, evenly spread.
    """

    def __init__(self, message: Any) -> None:
        self.message = message

    @property
    def points(self) -> int:
        """Of the grid."""
        return int(self.message.point_count)

    @property
    def work(self) -> float:
        """Seconds of processor time for the whole job."""
        return float(self.message.work)

    @property
    def time(self) -> float:
        """Seconds by the clock, if the server did nothing else."""
        return float(self.message.time)

    @property
    def memory(self) -> float:
        """Bytes that the point needs that needs most, with all workers; an upper bound."""
        return float(self.message.memory)

    @property
    def models(self) -> list[str]:
        """The model that would answer, for each planned point."""
        return [spelled(point, "model") for point in self.message.points]

    @property
    def reasons(self) -> list[str]:
        """Why that model, for each planned point."""
        return [str(point.reason) for point in self.message.points]

    def to_frame(self) -> pandas.DataFrame:
        """A pandas DataFrame, one row for each planned point and model, with samples, work (seconds
        of processor time) and relative errors; NaN where unknown. Needs pandas."""
        import pandas

        return pandas.DataFrame(self._rows())

    def __repr__(self) -> str:
        lines = [
            f" {mark:1} {model:<18} {work:>9}  {remark}"
            for mark, model, work, remark in self._shown()
        ]
        return "\n".join([self._heading(), *lines])

    def _repr_html_(self) -> str:
        return html_table(self._heading(), ("", "model", "work", "remark"), self._shown())

    def _shown(self) -> list[tuple[str, str, str, str]]:
        """The first rows: a mark of the chosen model, the model, its work and a remark."""
        return [
            (
                ">" if row["chosen"] else "",
                row["model"],
                f"{row['work']:.2g} s" if "work" in row else "",
                row["reason"],
            )
            for row in self._rows()[:_MOST_ROWS]
        ]

    def _heading(self) -> str:
        models = ", ".join(dict.fromkeys(self.models))
        return (
            f"points: {self.points}, by {models}: {self.work:.2g} s of processor time, "
            f"about {self.time:.2g} s with {self.message.workers} workers"
        )

    def _rows(self) -> list[dict[str, Any]]:
        return [_row(point, model) for point in self.message.points for model in point.models]


def _row(point: Any, model: Any) -> dict[str, Any]:
    parameters = point.parameters
    row: dict[str, Any] = {field.name: value for field, value in parameters.ListFields()}
    row["model"] = spelled(model, "model")
    row["chosen"] = model.model == point.model
    row["answers"] = model.answers
    for field in ("samples", "work", "relative_statistical_error", "relative_model_error"):
        if (value := value_of(model, field)) is not None:
            row[field] = value
    row["reason"] = model.reason
    return row
