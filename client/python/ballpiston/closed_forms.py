"""The paper's closed forms at pairs of rho and delta, as NumPy arrays."""

from typing import Any

import numpy as np

from ballpiston.fields import FloatArray, column
from ballpiston.suggestion import no_such
from ballpiston.table import frame_of
from ballpiston.v1 import analytic_pb2


def _numbers(message: Any) -> tuple[str, ...]:
    fields = message.DESCRIPTOR.fields
    return tuple(f.name for f in fields if f.message_type is None and f.label != f.LABEL_REPEATED)


_PAIR = _numbers(analytic_pb2.PairAnalytics)
_ENERGY = _numbers(analytic_pb2.EnergyAnalytics)
_CANONICAL = _numbers(analytic_pb2.CanonicalAnalytics)


class ClosedForms:
    """Closed forms, exact to a relative error of 1e-12.

    A name gives an array. The first axis is the pairs (rho, delta), rho outermost:

    - (pairs,): rho, delta, lambda, eta, cell_area, volume, area_ball_piston, area_ball_wall,
      area_piston_wall, tau_ball_piston, tau_ball_wall, tau_piston_wall (mean free times),
      pair_delta_bound, gas_delta_bound, rare_limit_rate
    - (pairs, energies): epsilon, phi, f, j, h, mean_free_time_conditional
    - (pairs, energies, outgoing energies): kernel
    - (pairs, temperatures), first those of `beta`: beta, temperature, mean_f, mean_energy_current,
      mean_h, exchange_rate, static_conductivity, rare_limit_exchange_rate

    Attributes:
        message: the message ballpiston.v1.EvaluatePairsResponse.

    Example:
        >>> forms = client.analytic(rho=0.5296, delta=[0.1, 0.2])
        >>> forms["tau_ball_piston"]
        array([53.01538682, 14.68040105])
    """

    def __init__(self, message: Any) -> None:
        self.message = message
        points = message.points
        self._arrays = {name: column(points, name) for name in _PAIR}
        for part, fields in (("energies", _ENERGY), ("canonical", _CANONICAL)):
            if points and getattr(points[0], part):
                for name in fields:
                    self._arrays[name] = np.array([column(getattr(p, part), name) for p in points])
        if points and points[0].energies and points[0].energies[0].kernel:
            kernel = [[list(energy.kernel) for energy in point.energies] for point in points]
            self._arrays["kernel"] = np.array(kernel)

    @property
    def names(self) -> list[str]:
        """The names that this answer has."""
        return list(self._arrays)

    def __len__(self) -> int:
        return len(self.message.points)

    def __getitem__(self, name: str) -> FloatArray:
        if name not in self._arrays:
            raise KeyError(no_such("closed form", name, "this answer", self._arrays))
        return self._arrays[name].copy()

    def to_frame(self) -> Any:
        """A pandas DataFrame: one row for each pair and, if there are energies or temperatures, one
        for each of these. The kernel is left out. Needs pandas."""
        rows = []
        for point in self.message.points:
            pair = {name: getattr(point, name) for name in _PAIR}
            parts = [(_ENERGY, e) for e in point.energies]
            parts += [(_CANONICAL, c) for c in point.canonical]
            for fields, part in parts or [((), None)]:
                rows.append(pair | {name: getattr(part, name) for name in fields})
        return frame_of(rows)

    def __repr__(self) -> str:
        return f"<closed forms at {len(self)} pairs: {', '.join(self.names)}>"
