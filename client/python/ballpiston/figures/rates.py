"""Collision rates from the probability of a collision in a short time (equations of the paper)

The probability P(t) of at least one event in a window of length t, divided by t and by the exact
rate, with one standard error, against t in units of the mean free time. As t tends to 0 the ratio
tends to 1. The dashed line is a Poisson process with the same rate.

a  all events: ball-piston, ball-wall and piston-wall
b  ball-piston events
c  ball-piston events given the piston's energy

All values of a line come from the same orbits. Therefore neighbouring points have nearly the same
statistical error. Time on two cores: quick 3 s, default 25 s, full 4 min.
"""

from typing import Any

import numpy as np

from ballpiston.figures.parts import style
from ballpiston.figures.parts.asking import RHO, Client, Numbers
from ballpiston.figures.parts.tables import FloatArray, Table, Tables, distinct
from ballpiston.figures.parts.tables import measured, rows, stacked

EFFORT = {"quick": {"events": 40_000}, "full": {"orbits": 20, "events": 1_000_000}}

_BATCHES = 8  # of each orbit; their scatter gives the standard errors
_FEWEST_GAPS = 50  # for which an error is stated
_HALF_WIDTH = 0.02  # a conditional rate is the rate at all energies within epsilon +- half_width
_ENERGIES = 20  # the exact conditional rate is averaged over this number of energies
_LENGTHS = 1e-4 * 10 ** (np.arange(17) / 4)  # of the windows, in units of the mean free time
_ASIDE = 1.12  # the points of successive energies are shifted in time by this factor


def measure(
    client: Client,
    *,
    rho: float = RHO,
    delta: float = 0.2,
    epsilon: Numbers = "0.05,0.15,0.25,0.35,0.45",
    seed: int = 0,
    orbits: int = 5,
    events: int = 400_000,
) -> Tables:
    """The rates P(t)/t of each kind of events. The first orbit has the seed `seed`, the next ones
    have the next seeds."""
    if events < _BATCHES:
        raise ValueError(f"events is {events}; permitted: {_BATCHES} to 1000000")
    kinds = _kinds(client, rho, delta, epsilon)
    batches: list[list[FloatArray]] = [[] for _ in kinds]
    names = ("time", "event", "piston_energy_before")
    for k in range(orbits):
        orbit = client.trace_arrays(*names, rho=rho, delta=delta, seed=seed + k, events=events)
        for kind, gaps in zip(kinds, batches):
            gaps += batches_of_gaps(orbit, kind)
    found = []
    for kind, gaps in zip(kinds, batches):
        lengths = _LENGTHS / kind["exact"]
        rate, error = rate_of_windows(gaps, lengths)
        found.append(kind | {"t": lengths, "rate": rate, "standard_error": error})
    return {"rates": stacked(found)}


def _kinds(client: Client, rho: float, delta: float, epsilon: Numbers) -> list[dict[str, Any]]:
    """The kinds of events, each with energies of the piston from `lower` to `upper` (all, if the
    kind is not "conditional") and its exact rate."""
    forms = client.analytic(rho, delta, epsilon)
    met, ball, piston = (
        1 / float(forms[f"tau_{name}"][0]) for name in ("ball_piston", "ball_wall", "piston_wall")
    )
    kinds = [("all", np.nan, 0, 0.5, met + ball + piston), ("ball_piston", np.nan, 0, 0.5, met)]
    middle = forms["epsilon"][0]
    lower, upper = np.maximum(middle - _HALF_WIDTH, 0), np.minimum(middle + _HALF_WIDTH, 0.5)
    # In equilibrium u = sqrt(2 epsilon) is uniform. Therefore energies that are evenly spaced in u
    # have equal weights.
    edges = np.linspace(np.sqrt(2 * lower), np.sqrt(2 * upper), _ENERGIES + 1)
    u = (edges[:-1] + edges[1:]) / 2
    times = client.analytic(rho, delta, u.ravel() ** 2 / 2)["mean_free_time_conditional"][0]
    rate = (1 / times.reshape(u.shape)).mean(axis=0)
    kinds += [("conditional", *numbers) for numbers in zip(middle, lower, upper, rate)]
    names = ("kind", "epsilon", "lower", "upper", "exact")
    return [dict(zip(names, kind)) for kind in distinct(kinds)]  # an energy may be repeated


def batches_of_gaps(orbit: Table, kind: dict[str, Any]) -> list[FloatArray]:
    """The gaps between the events of a kind, in batches of equally many events of the orbit: a gap
    belongs to the batch of its end. The piston's energy is constant during a gap between
    ball-piston events. Therefore the gaps of one energy give the conditional probability."""
    batch = np.arange(len(orbit["time"])) // (len(orbit["time"]) // _BATCHES)
    chosen = (orbit["event"] == "ball_piston") | (kind["kind"] == "all")
    gaps, batch = np.diff(orbit["time"][chosen], prepend=0.0), batch[chosen]
    if kind["kind"] == "conditional":
        energy = orbit["piston_energy_before"][chosen]
        near = (energy >= kind["lower"]) & (energy < kind["upper"])
        gaps, batch = gaps[near], batch[near]
    return [gaps[batch == k] for k in range(_BATCHES)]


def rate_of_windows(
    batches: list[FloatArray], lengths: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """P(t)/t of windows of each length, and its standard error.

    A window of length t that begins at a uniformly random time contains an event with the
    probability P(t), the sum of min(gap, t) over the gaps between events, divided by the sum of the
    gaps. The standard error is that of a ratio of sums over batches; it is NaN for fewer than
    _FEWEST_GAPS gaps. All t use the same gaps: their errors are not independent. Without a gap the
    rate is NaN, too."""
    hits = np.array([[np.minimum(gaps, t).sum() for t in lengths] for gaps in batches])
    times = np.array([gaps.sum() for gaps in batches])
    total = times.sum() or np.nan
    probability = hits.sum(axis=0) / total
    scatter = np.sum((hits - np.outer(times, probability)) ** 2, axis=0)
    count = len(batches)
    is_known = sum(map(len, batches)) >= _FEWEST_GAPS
    error = np.sqrt(scatter * count / (count - 1)) / total if is_known else np.nan * lengths
    return probability / lengths, error / lengths


@style.styled
def draw(tables: Tables) -> style.Figure:
    data = tables["rates"]
    titles = ("all events", "ball-piston events", "ball-piston events, given ε")
    figure, panels = style.panels((1200, 500), 1, 3, titles, sharey=True)
    window = np.logspace(-4.3, 0.2, 200)
    poisson = {"color": style.GREY, "dashes": (6, 4), "label": "Poisson process"}
    for axes, unit in zip(panels, ("t/τ", "t/τ$_{bp}$", "t/τ(ε)")):
        style.level(axes, 1, linewidth=1.5)
        axes.semilogx(window, -np.expm1(-window) / window, **poisson)
        axes.set(xlim=(6e-5, 1.7), xlabel=unit)
    several = [(0, rows(data, kind="all"), style.BLUE, "", 0.0)]
    several += [(1, rows(data, kind="ball_piston"), style.BLUE, "", 0.0)]
    conditional = style.series(rows(data, kind="conditional"), "epsilon", "ε")
    for k, series in enumerate(conditional):
        several.append((2, *series, k - (len(conditional) - 1) / 2))
    for panel, part, colour, label, shift in several:
        t = part["t"] * part["exact"]
        ratio = measured(part, "rate", unit=part["exact"])
        style.error_points(panels[panel], t * _ASIDE**shift, *ratio, colour, label)
    panels[0].set_ylabel("P(t)/t over the exact rate")
    panels[2].legend(loc="lower left")
    return figure
