"""The second Lyapunov exponent at rare ball-piston collisions, from statistics of one collision.

docs/research/chaos.md derives the growth in a collision between the waits t and t':

  G = ln |[S(t') M S(t)]_12 / t| = ln t' + ln |M_21| + terms that vanish for t, t' -> infinity,
  S(t) = (1 t; 0 1),   M = c (1 - P) + P/c,   P the projection on (1, v k) along (1, -v' k'),
  |M_21| = vy^2 / |p p'| * k k' / (v k + v' k').

Here c = p p'/(v v'), p is the piston's velocity, v the ball's speed, k the curvature of the ball's
unstable front, and a prime means after the collision. Velocities and waits have the laws of the
limit of rare collisions: velocities on the unit sphere have a density proportional to (vx - p)+.
Positions are uniform on the collision surface at the actual delta. The curvatures follow from the
ball's flights in its cell with a closed tip.
"""

import numpy as np

from ballpiston.figures.parts.cell_outline import CENTRES, half_height, overlap_length
from ballpiston.figures.parts.tables import FloatArray

_TOLERANCE = 1e-10  # relative, of a front's curvature
_MOST_HITS = 400  # of the ball until then: 16 in most cells, 100 for rho near 1/2 or 1/sqrt(2)
_CHUNK = 16_384  # collisions that are followed together
_SMALLEST_COSINE = 1e-12
_GRID = 4096  # of depths
_NODES = 200_000  # of integrals over the piston's speed


def collision_rate(piston_speed: FloatArray) -> FloatArray:
    """The rate of collisions at a piston's speed, over its mean: phi of the closed forms."""
    ball_speed = np.sqrt(1 - piston_speed**2)
    cosine = np.minimum(piston_speed / ball_speed, 1)
    angle, sine = np.arccos(cosine), np.sqrt(1 - cosine**2)
    approach = (ball_speed * sine - piston_speed * angle) / np.pi + piston_speed / 2
    rate: FloatArray = approach * 2 * np.sqrt(2)
    return rate


def mean_logarithms() -> tuple[float, float]:
    """<ln(t/tau)>: a collision is followed by the piston speed u with the density phi(u), and by an
    exponential wait of the mean tau/phi(u). <ln(vy^2/|p p'|)>: |p| and |p'| have the density phi,
    and <ln vy^2> = -1 - 2 ln 2."""
    speeds = (np.arange(_NODES) + 0.5) / _NODES
    phi = collision_rate(speeds)
    of_phi = float((phi * np.log(phi)).mean())
    of_speeds = float((phi * np.log(speeds)).mean())
    return -np.euler_gamma - of_phi, -1 - 2 * float(np.log(2)) - 2 * of_speeds


def draw(
    rng: np.random.Generator, rho: float, delta: float, count: int
) -> tuple[FloatArray, ...]:
    """Ball-piston collisions from the invariant measure of the return map
    (core/sampling/collision_surface.h): the ball's x, y, and before the collision its vx, vy and
    the piston's velocity."""
    depths = np.linspace(0, delta, _GRID + 1)  # with a density proportional to the cell's height
    heights = half_height(rho, depths)
    below = np.concatenate([[0.0], np.cumsum(heights[1:] + heights[:-1])])
    depth = np.interp(rng.random(count) * below[-1], below, depths)
    y = half_height(rho, depth) * (2 * rng.random(count) - 1)
    normal = np.sqrt(rng.random(count))  # (vx - p)/sqrt(2)
    across, angle = np.sqrt(1 - normal**2), 2 * np.pi * rng.random(count)
    along = across * np.cos(angle)  # (vx + p)/sqrt(2)
    vx, p = (along + normal) / np.sqrt(2), (along - normal) / np.sqrt(2)
    return (1 - overlap_length(rho)) / 2 - depth, y, vx, across * np.sin(angle), p


def mixing_matrix(c: FloatArray, unstable: FloatArray, stable: FloatArray) -> FloatArray:
    """M of each collision, (2, 2, count), where the directions of P are (1, unstable) and
    (1, -stable)."""
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


def second_exponent(
    rho: float, delta: float, tau: float, samples: int, seed: int = 0
) -> dict[str, float]:
    """lambda_2 per collision at the mean free time `tau`. `long_waits` is lambda_2 without the
    terms in 1/t. The means of the logarithms of the wait and of vy^2/|p p'| are known, so only what
    remains is sampled."""
    rng = np.random.default_rng([seed, samples])
    parts = [
        _remainders(rng, rho, delta, tau, min(_CHUNK, samples - first))
        for first in range(0, samples, _CHUNK)
    ]
    whole, curvature = np.concatenate(parts, axis=1)
    wait, velocities = mean_logarithms()
    known = np.log(tau) + wait + velocities
    return {
        "computed": known + whole.mean(),
        "computed_error": whole.std() / np.sqrt(samples),
        "long_waits": known + curvature.mean(),
    }


def _remainders(
    rng: np.random.Generator, rho: float, delta: float, tau: float, count: int
) -> FloatArray:
    """Two rows: G less ln t' and ln(vy^2/|p p'|), and the same of ln t' + ln |M_21|."""
    x, y, vx, vy, p = draw(rng, rho, delta, count)
    before, after = np.hypot(vx, vy), np.hypot(p, vy)  # the ball's speeds
    unstable = before * stable_curvature(rho, x, y, -vx / before, -vy / before)
    stable = after * stable_curvature(rho, x, y, p / after, vy / after)
    m = mixing_matrix(p * vx / (before * after), unstable, stable)
    of_piston = np.abs([p, vx])  # its speeds before and after
    earlier, later = tau * rng.exponential(size=(2, count)) / collision_rate(of_piston)
    grown = m[0, 0] + m[0, 1] / earlier + later * (m[1, 0] + m[1, 1] / earlier)
    velocities = vy**2 / of_piston.prod(axis=0)
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
