"""What a question would cost with each model, and which model would answer."""

from typing import Any

from ballpiston.fields import shown, spelled, value_of
from ballpiston.table import frame_of, html_table

_MOST_ROWS = 25


class Plan:
    """The ladder of models for a question. Nothing was run.

    Attributes:
        message: the message ballpiston.v1.PlanEnsembleJobResponse. Of a grid with more than 1,000
            points it has as many, evenly spread.
    """

    points = shown(lambda plan: int(plan.point_count), "Number of grid points.")
    work = shown(lambda plan: float(plan.work), "Seconds of processor time for the whole job.")
    time = shown(lambda plan: float(plan.time), "Seconds by the clock, if nothing else ran.")
    memory = shown(lambda plan: float(plan.memory), "Bytes of the largest point; an upper bound.")
    models = shown(
        lambda plan: [spelled(point, "model") for point in plan.points],
        "The model that would answer, for each planned point.",
    )
    reasons = shown(
        lambda plan: [str(point.reason) for point in plan.points],
        "Why that model, for each planned point.",
    )

    def __init__(self, message: Any) -> None:
        self.message = message

    def to_frame(self) -> Any:
        """A pandas DataFrame, one row for each planned point and model, with samples, work (seconds
        of processor time) and relative errors; NaN where unknown. Needs pandas."""
        return frame_of(self._rows())

    def __repr__(self) -> str:
        lines = [" {:1} {:<18} {:>9}  {}".format(*row) for row in self._shown()]
        return "\n".join([self._heading(), *lines])

    def _repr_html_(self) -> str:
        return html_table(self._heading(), ("", "model", "work", "remark"), self._shown())

    def _shown(self) -> list[tuple[str, str, str, str]]:
        """The first rows: a mark of the chosen model, the model, its work and a remark."""
        shown = []
        for row in self._rows()[:_MOST_ROWS]:
            work = f"{row['work']:.2g} s" if "work" in row else ""
            shown.append((">" if row["chosen"] else "", row["model"], work, row["reason"]))
        return shown

    def _heading(self) -> str:
        models = ", ".join(dict.fromkeys(self.models))
        return (
            f"points: {self.points}, by {models}: {self.work:.2g} s of processor time, "
            f"about {self.time:.2g} s with {self.message.workers} workers"
        )

    def _rows(self) -> list[dict[str, Any]]:
        return [_row(point, model) for point in self.message.points for model in point.models]


def _row(point: Any, model: Any) -> dict[str, Any]:
    row: dict[str, Any] = {field.name: value for field, value in point.parameters.ListFields()}
    row["model"] = spelled(model, "model")
    row["chosen"] = model.model == point.model
    row["answers"] = model.answers
    for field in ("samples", "work", "relative_statistical_error", "relative_model_error"):
        if (value := value_of(model, field)) is not None:
            row[field] = value
    row["reason"] = model.reason
    return row
