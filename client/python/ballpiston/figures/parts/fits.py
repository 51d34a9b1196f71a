"""Weighted least squares: linear models of values with known errors."""

from typing import NamedTuple

import numpy as np

from ballpiston.figures.parts.tables import FloatArray


class Fit(NamedTuple):
    """Coefficients with their standard errors, and chi-squared with its degrees of freedom."""

    coefficients: FloatArray
    errors: FloatArray
    chi_squared: float
    freedom: int

    def row(self, *names: str) -> dict[str, float]:
        """The first coefficients by name, their errors, and chi-squared, for a table."""
        row: dict[str, float] = {}
        for name, coefficient, error in zip(names, self.coefficients, self.errors):
            row |= {name: coefficient, f"{name}_error": error}
        return row | {"chi_squared": self.chi_squared, "freedom": self.freedom}


def linear(
    terms: FloatArray, values: FloatArray, errors: FloatArray, correlation: FloatArray | None = None
) -> Fit:
    """values = terms @ coefficients; one row of `terms` for each value. NaN if the values do not
    determine the coefficients. By default the values are independent."""
    white = np.column_stack([terms, values]) / errors[:, np.newaxis]
    if correlation is not None:
        white = np.linalg.solve(np.linalg.cholesky(correlation), white)
    terms, values = white[:, :-1], white[:, -1]
    count = terms.shape[1]
    coefficients, _, rank, _ = np.linalg.lstsq(terms, values, rcond=None)
    if rank < count:
        unknown = np.full(count, np.nan)
        return Fit(unknown, unknown, np.nan, 0)
    residuals = values - terms @ coefficients
    variances = np.diag(np.linalg.inv(terms.T @ terms))
    chi_squared = float(residuals @ residuals)
    return Fit(coefficients, np.sqrt(variances), chi_squared, len(values) - count)
