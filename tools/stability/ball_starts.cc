#include <Eigen/Core>
#include <array>
#include <cmath>

#include "core/billiard/event_flow.h"
#include "tools/stability/pair_starts.h"

namespace ballpiston::stability {
namespace {

using Eigen::Vector2d;

Vector2d Perpendicular(const Vector2d& a) { return {-a.y(), a.x()}; }

double RandomSign(CounterRandom& random) { return (random.Bits() >> 63) != 0 ? 1 : -1; }

Vector2d RandomCentre(CounterRandom& random) {
  const double x = 0.5 * RandomSign(random);
  return {x, 0.5 * RandomSign(random)};
}

// A point of the arc of the disc around `centre`, as a unit vector from the centre. The arc has the
// angles pi/4 +- (pi/4 - atan(lambda)). The tangent of the half angle is uniform, which agrees with
// a uniform angle to within a few per cent.
Vector2d RandomNormal(const PairGeometry& geometry, const Vector2d& centre, CounterRandom& random) {
  // tan(pi/8 - atan(lambda)/2) from tan(pi/4 - atan(lambda)) = tip/(1 - tip), as lambda = 1 - 2 tip
  const double whole = geometry.tip() / (1 - geometry.tip());
  const double half = whole / (1 + std::sqrt(1 + whole * whole));
  const double t = half * (2 * random.Uniform() - 1);
  const double cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
  const Vector2d inward = -centre * M_SQRT2;
  return inward * cosine + Perpendicular(inward) * sine;
}

// Whether the ball, on the disc in its quadrant, leaves the disc.
bool LeavesWall(const Vector2d& position, const Vector2d& direction) {
  const Vector2d centre = {std::copysign(0.5, position.x()), std::copysign(0.5, position.y())};
  return direction.dot(position - centre) > 0;
}

PairState BallAlone(const PairGeometry& geometry, const Vector2d& position,
                    const Vector2d& direction) {
  return {.position = position,
          .direction = direction.normalized(),
          .ball_speed = 1,
          .piston = geometry.piston_right(),
          .piston_velocity = 0};
}

// The point where a ball from `position` hits the next wall.
Vector2d WallAhead(const PairGeometry& geometry, const Vector2d& position,
                   const Vector2d& direction) {
  ReferenceFlow flow(geometry, BallAlone(geometry, position, direction));
  flow.Step();
  return flow.state().position;
}

}  // namespace

double RandomOffset(CounterRandom& random) {
  static constexpr std::array<double, 16> kOffsets = {0,     1e-3,  1e-4,  1e-5,  1e-6,  1e-7,
                                                      1e-8,  1e-9,  1e-10, 1e-11, 1e-12, 1e-13,
                                                      1e-14, 1e-15, 1e-16, 1e-17};
  const uint64_t bits = random.Bits();
  return kOffsets[bits >> 60] * ((bits & 1) != 0 ? 1 : -1);
}

PairState AnywhereOnWall(const PairGeometry& geometry, CounterRandom& random) {
  const Vector2d centre = RandomCentre(random);
  const Vector2d normal = RandomNormal(geometry, centre, random);
  const double sine = 2 * random.Uniform() - 1;
  return BallAlone(geometry, centre + geometry.rho() * normal,
                   normal * std::sqrt((1 - sine) * (1 + sine)) + Perpendicular(normal) * sine);
}

PairState AimedAtTip(const PairGeometry& geometry, CounterRandom& random) {
  // Seen from the tip at (t, 0), the cell lies within +-atan(lambda) of the axis.
  const double slope = geometry.lambda() * (2 * random.Uniform() - 1);
  const uint64_t side = random.Bits();
  const auto turned = [&](double x, double y) {
    const Vector2d v = (side & 1) != 0 ? Vector2d(x, y) : Vector2d(y, x);
    return (side & 2) != 0 ? v : Vector2d(-v);
  };
  for (;;) {
    const Vector2d from =
        WallAhead(geometry, turned(geometry.tip(), 0), turned(-1, slope).normalized());
    const Vector2d axis = (turned(geometry.tip(), 0) - from).normalized();
    const Vector2d direction = axis + RandomOffset(random) * Perpendicular(axis);
    if (LeavesWall(from, direction)) return BallAlone(geometry, from, direction);
  }
}

PairState AimedToGraze(const PairGeometry& geometry, CounterRandom& random) {
  for (;;) {
    const Vector2d centre = RandomCentre(random);
    const Vector2d normal = RandomNormal(geometry, centre, random);
    const double side = RandomSign(random);
    const Vector2d from = WallAhead(geometry, centre + geometry.rho() * normal,
                                    Vector2d(side * Perpendicular(normal)));
    const double distance = (centre - from).norm();
    const double sine = side * geometry.rho() * (1 - RandomOffset(random)) / distance;
    if (!(std::fabs(sine) < 1)) continue;
    const Vector2d axis = (centre - from) / distance;
    const Vector2d direction =
        axis * std::sqrt((1 - sine) * (1 + sine)) + Perpendicular(axis) * sine;
    if (LeavesWall(from, direction)) return BallAlone(geometry, from, direction);
  }
}

}  // namespace ballpiston::stability
