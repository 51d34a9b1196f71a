"""Weighted least squares: linear models of values with known errors."""

from __future__ import annotations

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

    def whitened(scaled: FloatArray) -> FloatArray:
        if correlation is None:
            return scaled
        white: FloatArray = np.linalg.inv(np.linalg.cholesky(correlation)) @ scaled
        return white

    weighted = whitened(terms / errors[:, np.newaxis])
    rank = np.linalg.matrix_rank(weighted) if weighted.size else 0
    if rank < terms.shape[1]:
        unknown = np.full(terms.shape[1], np.nan)
        return Fit(unknown, unknown, np.nan, 0)
    covariance = np.linalg.inv(weighted.T @ weighted)
    coefficients = covariance @ weighted.T @ whitened(values / errors)
    residuals = whitened((values - terms @ coefficients) / errors)
    freedom = len(values) - terms.shape[1]
    return Fit(coefficients, np.sqrt(np.diag(covariance)), float(residuals @ residuals), freedom)


def powers(x: FloatArray, highest: int) -> FloatArray:
    """The terms 1, x, ..., x^highest of a polynomial."""
    return np.vander(x, highest + 1, increasing=True)


def mean(values: FloatArray, errors: FloatArray, correlation: FloatArray | None = None) -> Fit:
    """The weighted mean."""
    return linear(np.ones((len(values), 1)), values, errors, correlation)
