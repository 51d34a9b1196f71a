#include "core/sampling/invariant_measure.h"

#include <cmath>

#include "core/sampling/collision_surface.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

struct Positions {
  Eigen::Vector2d ball;
  double piston;
};

// Uniform on Gamma.
Positions UniformPositions(const PairGeometry& geometry, CounterRandom& random) {
  const double half_width = geometry.tip();
  const double stroke = geometry.piston_right() - geometry.piston_left();
  for (;;) {
    const Eigen::Vector2d ball = {(2 * random.Uniform() - 1) * half_width,
                                  (2 * random.Uniform() - 1) * half_width};
    const double piston = geometry.piston_left() + stroke * random.Uniform();
    if (InsideCell(geometry, ball) && ball.x() < piston) return {ball, piston};
  }
}

}  // namespace

PairState DrawFromFlowMeasure(const PairGeometry& geometry, CounterRandom& random) {
  const Positions positions = UniformPositions(geometry, random);
  // Archimedes: a coordinate of a uniform point of the sphere is uniform.
  const double v3 = 2 * random.Uniform() - 1;
  return {.position = positions.ball,
          .direction = UniformDirection(random),
          .ball_speed = std::sqrt((1 - v3) * (1 + v3)),
          .piston = positions.piston,
          .piston_velocity = v3};
}

PairState DrawFromFlowMeasureAt(const PairGeometry& geometry, double epsilon,
                                CounterRandom& random) {
  const Positions positions = UniformPositions(geometry, random);
  const double speed = std::sqrt(2 * epsilon);
  return {.position = positions.ball,
          .direction = UniformDirection(random),
          .ball_speed = std::sqrt(1 - 2 * epsilon),
          .piston = positions.piston,
          .piston_velocity = random.Uniform() < 0.5 ? -speed : speed};
}

PairState DrawFromCollisionMeasure(const PairGeometry& geometry, CounterRandom& random) {
  const Eigen::Vector2d ball = UniformOnCollisionSurface(geometry, random);
  // The cosine law: the square of the normal component is uniform, and the tangential part has a
  // uniform direction in the plane spanned by (0, 1, 0) and (1, 0, 1)/sqrt(2).
  const double square = random.Uniform();
  const Eigen::Vector2d tangential = UniformDirection(random) * std::sqrt(1 - square);
  const double normal = std::sqrt(square);
  const double v1 = (tangential.y() - normal) * M_SQRT1_2;
  const double v3 = (tangential.y() + normal) * M_SQRT1_2;
  return WithVelocities(ball, {v1, tangential.x()}, ball.x(), v3);
}

}  // namespace ballpiston
