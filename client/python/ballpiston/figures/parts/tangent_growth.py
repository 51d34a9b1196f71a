"""The second Lyapunov exponent at rare ball-piston collisions, from statistics of one collision.

docs/research/chaos.md derives it. A ball-piston collision after a wait t maps the part (b, B) of a
tangent vector that does not grow in the ball's direction, up to its sign, by M S(t), with

  S(t) = (1 t; 0 1),
  M = c (1 - P) + P/c,     P the projection on (1, v k) along (1, -v' k').

Here c = p p'/(v v'), p is the piston's velocity, v the ball's speed, k the curvature of the ball's
unstable front, and a prime means after the collision. The growth in a collision is

  G = ln |[S(t') M S(t)]_12 / t| = ln t' + ln |M_21| + terms that vanish for t, t' -> infinity,
  |M_21| = vy^2 / |p p'| * k k' / (v k + v' k').

The distributions are those of the limit of rare collisions: velocities on the unit sphere have a
density proportional to (vx - p)+, and the wait after a collision is exponential, with a rate that
depends on the piston's speed. Positions are uniform on the collision surface at the actual delta.
The curvatures follow from the ball's flights in its cell with a closed tip.
"""

from typing import NamedTuple

import numpy as np

from ballpiston.figures.parts.cell_outline import CENTRES, half_height, overlap_length
from ballpiston.figures.parts.tables import FloatArray

_TOLERANCE = 1e-10  # relative, of a front's curvature
_MOST_HITS = 400  # of the ball until then: 16 in most cells, 100 for rho near 1/2 or 1/sqrt(2)
_CHUNK = 16_384  # collisions that are followed together
_SMALLEST_COSINE = 1e-12
_GRID = 4096  # of depths
_NODES = 200_000  # of an integral over the piston's speed


class Collisions(NamedTuple):
    """Ball-piston collisions: the ball's position and the velocities before."""

    x: FloatArray
    y: FloatArray
    ball_vx: FloatArray
    ball_vy: FloatArray
    piston_v: FloatArray


class Growth(NamedTuple):
    """lambda_2 per collision, in columns of a table: the mean, its standard error, and the mean
    without the terms in 1/t, for long waits."""

    computed: float
    computed_error: float
    long_waits: float


def collision_rate(piston_speed: FloatArray) -> FloatArray:
    """The rate of collisions at a piston's speed, over its mean: phi of the closed forms."""
    ball_speed = np.sqrt(1 - piston_speed**2)
    cosine = np.minimum(piston_speed / ball_speed, 1)
    angle, sine = np.arccos(cosine), np.sqrt(1 - cosine**2)
    approach = (ball_speed * sine - piston_speed * angle) / np.pi + piston_speed / 2
    rate: FloatArray = approach * 2 * np.sqrt(2)
    return rate


def draw(rng: np.random.Generator, rho: float, delta: float, count: int) -> Collisions:
    """From the invariant measure of the return map (core/sampling/collision_surface.h)."""
    depth = _depths(rng, rho, delta, count)
    y = half_height(rho, depth) * (2 * rng.random(count) - 1)
    normal = np.sqrt(rng.random(count))  # (vx - p)/sqrt(2)
    across, angle = np.sqrt(1 - normal**2), 2 * np.pi * rng.random(count)
    along = across * np.cos(angle)  # (vx + p)/sqrt(2)
    vx, p = (along + normal) / np.sqrt(2), (along - normal) / np.sqrt(2)
    return Collisions((1 - overlap_length(rho)) / 2 - depth, y, vx, across * np.sin(angle), p)


def mixing(rho: float, collisions: Collisions) -> FloatArray:
    """M of each collision, (2, 2, count)."""
    x, y, vx, vy, p = collisions
    before, after = np.hypot(vx, vy), np.hypot(p, vy)  # the ball's speeds
    unstable = before * stable_curvature(rho, x, y, -vx / before, -vy / before)
    stable = after * stable_curvature(rho, x, y, p / after, vy / after)
    return mixing_matrix(p * vx / (before * after), unstable, stable)


def mixing_matrix(c: FloatArray, unstable: FloatArray, stable: FloatArray) -> FloatArray:
    """M, where the directions of P are (1, unstable) and (1, -stable)."""
    ones = np.ones_like(unstable)
    projection = np.array([[stable, ones], [unstable * stable, unstable]]) / (unstable + stable)
    matrix: FloatArray = c * (np.eye(2)[:, :, np.newaxis] - projection) + projection / c
    return matrix


def stable_curvature(
    rho: float, x: FloatArray, y: FloatArray, ux: FloatArray, uy: FloatArray
) -> FloatArray:
    """k of the fronts (a, -k a) of a ball with the direction u that contract for ever: the map of
    many flights and hits takes them to the angle 0. Backwards in time they are unstable fronts."""
    spread, turned = np.zeros_like(x), np.ones_like(x)  # of the front (0, 1)
    flat, bent = np.ones_like(x), np.zeros_like(x)  # of the front (1, 0)
    for _ in range(_MOST_HITS):
        earlier = bent
        length, nx, ny = _next_hit(rho, x, y, ux, uy)
        cosine = ux * nx + uy * ny
        bend = 2 / (rho * np.maximum(-cosine, _SMALLEST_COSINE))
        x, y = x + length * ux, y + length * uy
        ux, uy = ux - 2 * cosine * nx, uy - 2 * cosine * ny
        speed = np.hypot(ux, uy)  # 1, but for rounding, which would grow
        ux, uy = ux / speed, uy / speed
        flat, spread = flat + length * bent, spread + length * turned
        bent, turned = bent + bend * flat, turned + bend * spread
        unit = 1 / turned  # all four grow exponentially
        flat, spread, bent, turned = flat * unit, spread * unit, bent * unit, turned * unit
        if np.allclose(bent, earlier, rtol=_TOLERANCE, atol=0):
            break
    return bent


def second_exponent(rho: float, delta: float, tau: float, samples: int, seed: int = 0) -> Growth:
    """lambda_2 in a collision, at the mean free time `tau`. The means of the logarithms of the wait
    and of vy^2/|p p'| are known, so only what remains is sampled."""
    rng = np.random.default_rng([seed, samples])
    parts = [
        _remainders(rng, rho, delta, tau, min(_CHUNK, samples - first))
        for first in range(0, samples, _CHUNK)
    ]
    whole, curvature = np.concatenate(parts, axis=1)
    known = np.log(tau) + mean_log_wait() + mean_log_velocities()
    error = float(whole.std() / np.sqrt(samples))
    return Growth(known + float(whole.mean()), error, known + float(curvature.mean()))


def mean_log_wait() -> float:
    """<ln(t/tau)>: a collision is followed by the piston speed u with the density phi(u), and by an
    exponential wait of the mean tau/phi(u)."""
    phi = collision_rate(_speeds())
    return -float(np.euler_gamma) - float((phi * np.log(phi)).mean())


def mean_log_velocities() -> float:
    """<ln(vy^2/|p p'|)>: |p| and |p'| have the density phi, and <ln vy^2> = -1 - 2 ln 2."""
    speeds = _speeds()
    of_pistons = float((collision_rate(speeds) * np.log(speeds)).mean())
    return -1 - 2 * float(np.log(2)) - 2 * of_pistons


def _remainders(
    rng: np.random.Generator, rho: float, delta: float, tau: float, count: int
) -> FloatArray:
    """Two rows: G less ln t' and ln(vy^2/|p p'|), and the same of ln t' + ln |M_21|."""
    collisions = draw(rng, rho, delta, count)
    p, p_after = np.abs(collisions.piston_v), np.abs(collisions.ball_vx)
    earlier = tau * rng.exponential(size=count) / collision_rate(p)
    later = tau * rng.exponential(size=count) / collision_rate(p_after)
    m = mixing(rho, collisions)
    grown = m[0, 0] + m[0, 1] / earlier + later * (m[1, 0] + m[1, 1] / earlier)
    velocities = collisions.ball_vy**2 / (p * p_after)
    remainders: FloatArray = np.log(np.abs([grown / later, m[1, 0]]) / velocities)
    return remainders


def _next_hit(
    rho: float, x: FloatArray, y: FloatArray, ux: FloatArray, uy: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The length of the flight to the next disc, and the disc's normal there."""
    centres = np.array(CENTRES)
    dx, dy = x - centres[:, :1], y - centres[:, 1:]
    along = dx * ux + dy * uy
    square = along**2 - (dx**2 + dy**2 - rho**2)
    hits = (along < 0) & (square > 0)
    # Rounding may put the ball into the disc.
    found = np.where(hits, np.maximum(-along - np.sqrt(np.where(hits, square, 0)), 0), np.inf)
    length, (cx, cy) = found.min(axis=0), centres[found.argmin(axis=0)].T
    return length, (x + length * ux - cx) / rho, (y + length * uy - cy) / rho


def _depths(rng: np.random.Generator, rho: float, delta: float, count: int) -> FloatArray:
    """Distances from the tip, with a density proportional to the cell's height there."""
    grid = np.linspace(0, delta, _GRID + 1)
    height = half_height(rho, grid)
    below = np.concatenate([[0.0], np.cumsum(height[1:] + height[:-1])])
    return np.interp(rng.random(count) * below[-1], below, grid)


def _speeds() -> FloatArray:
    return (np.arange(_NODES) + 0.5) / _NODES
