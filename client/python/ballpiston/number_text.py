"""Numbers as text for people."""

from __future__ import annotations

import math

_SMALLEST, _LARGEST = 1e-4, 1e7  # outside these a number has an exponent
_ROUNDING = 5e-13  # an error below this share of the value is that of rounding


def measured_text(value: float, error: float | None = None) -> str:
    """A value to the digits that its standard error supports: 21.63 ± 0.12. Without an error it has
    six significant digits; with an error of 0, or of rounding only, twelve and no error."""
    if error is None or math.isnan(error):
        return f"{value:.6g}"
    if 0 <= error < _ROUNDING * abs(value):
        return f"{value:.12g}"
    if not (error > 0 and math.isfinite(error) and math.isfinite(value)):
        return f"{value:.6g} ± {error:.6g}"
    last = math.floor(math.log10(error)) - 1  # power of ten of the error's second digit
    size = max(abs(value), error)
    if _SMALLEST <= size < _LARGEST:
        decimals = max(0, -last)
        return f"{value:.{decimals}f} ± {error:.{decimals}f}"
    return f"{_scientific(value, last)} ± {_scientific(error, last)}"


def _scientific(x: float, last: int) -> str:
    digits = 0 if x == 0 else max(0, math.floor(math.log10(abs(x))) - last)
    return f"{x:.{digits}e}"
