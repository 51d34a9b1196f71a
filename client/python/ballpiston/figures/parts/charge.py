"""Growth of the cumulants of the charge of gas-conduction, from window to window.

The result has v(t) = c_n(t)/t at windows that double. Its part that falls as 1/t cancels in

    growth(t) = [c_n(2 t) - c_n(t)]/t = 2 v(2 t) - v(t)

If successive windows are independent and Gaussian, the estimates of v(t) and v(2 t) have the
correlation 2^((1 - n)/2), and the estimates of v(2 t) - v(t) at different t are independent. The
estimates of growth(t) are correlated (`correlations`). The errors here assume this.
"""

import numpy as np

from ballpiston.figures.parts.tables import FloatArray, Table
from ballpiston.point import Point


def combined(point: Point, order: int, longer: float) -> Table:
    """`value` is longer v(2 t) - v(t), and `shorter` is v(t). With longer = 2 the value is
    growth(t). With longer = 1 the value is 0 at long times if c_n grows as t."""
    names = {curve.name for curve in point.curves}
    if (name := f"charge_cumulant_{order}_by_window") not in names:
        return {part: np.empty(0) for part in ("time", "shorter", "value", "standard_error")}
    curve = point.curve(name)
    v, error = curve.value, curve.standard_error
    correlation = 2 ** ((1 - order) / 2)
    variance = (longer * error[1:]) ** 2 + error[:-1] ** 2
    variance -= 2 * longer * correlation * error[1:] * error[:-1]
    return {
        "time": curve.x[:-1],
        "shorter": v[:-1],
        "value": longer * v[1:] - v[:-1],
        "standard_error": np.sqrt(variance),
    }


def correlations(chain: FloatArray, order: int) -> FloatArray:
    """Of growth(t) at successive windows of several chains, one below the other; `chain` has the
    chain of each value. Chains are independent."""
    steps = np.abs(np.subtract.outer(np.arange(len(chain)), np.arange(len(chain))))
    ratio = 2.0 ** (order - 1)  # of the variances of v(2 t) and v(t)
    neighbours = (2 * ratio - 1) / (4 * ratio - 3) * ratio ** (-steps / 2)
    found: FloatArray = np.where(steps > 0, neighbours * np.equal.outer(chain, chain), 1.0)
    return found
