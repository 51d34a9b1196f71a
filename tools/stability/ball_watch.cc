#include "tools/stability/ball_watch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ballpiston::stability {
namespace {

// If two discs are nearer than this, the ball touches both: at a tip it may have hit either of
// them.
constexpr double kTouching = 1e-7;

// The centres of the nearest disc, which is in the ball's quadrant, and of its two neighbours.
std::array<Eigen::Vector2d, 3> NearestCentres(const Eigen::Vector2d& position) {
  const double x = std::copysign(0.5, position.x()), y = std::copysign(0.5, position.y());
  return {Eigen::Vector2d(x, y), Eigen::Vector2d(x, -y), Eigen::Vector2d(-x, y)};
}

}  // namespace

double ShortFlight(const PairGeometry& geometry, double epsilon) {
  return std::min(kShortUlps * epsilon, 1e-3 * geometry.tip());
}

BallWatch::BallWatch(const PairGeometry& geometry, double epsilon)
    : rho_(geometry.rho()),
      epsilon_(epsilon),
      standstill_(ShortFlight(geometry, epsilon), LongestTipSequence(geometry)) {}

bool BallWatch::Hit(const Eigen::Vector2d& position, const Eigen::Vector2d& direction,
                    double length, Failures& failures) {
  ++failures.hits;
  failures.negative_times += length < 0;
  // Written as negations, so that NaN counts as an escape. The slack is at least the first bound,
  // which costs less.
  const double depth = Depth(position);
  const bool is_free = depth <= kPositionUlps * epsilon_ || depth <= Slack(position, direction);
  if (!(position.array().abs() <= 0.5).all() || !is_free) {
    ++failures.escapes;
    return false;
  }
  failures.inward += HeadsInward(position, direction);
  return !standstill_.See(length, failures);
}

bool BallWatch::IsInCell(const Eigen::Vector2d& position, Failures& failures) const {
  // Away from walls the cosine that magnified the rounding error is unknown; therefore this is the
  // depth for the worst case, a grazing ball.
  const bool is_inside = Depth(position) <= kPositionUlps * std::sqrt(epsilon_);
  failures.escapes += !is_inside;
  return is_inside;
}

double BallWatch::Depth(const Eigen::Vector2d& position) const {
  return rho_ - (position - NearestCentres(position)[0]).norm();
}

double BallWatch::Slack(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) const {
  double cosine = 1;
  for (const Eigen::Vector2d& centre : NearestCentres(position)) {
    const Eigen::Vector2d normal = position - centre;
    if (normal.norm() > rho_ + kTouching) continue;
    cosine = std::min(cosine, std::fabs(direction.dot(normal)) / rho_);
  }
  return kPositionUlps * epsilon_ / std::max(cosine, std::sqrt(epsilon_));
}

bool BallWatch::HeadsInward(const Eigen::Vector2d& position,
                            const Eigen::Vector2d& direction) const {
  const std::array<Eigen::Vector2d, 3> centres = NearestCentres(position);
  const auto inward = [&](const Eigen::Vector2d& centre) {
    return direction.dot(position - centre) < -kDirectionUlps * epsilon_;
  };
  const double touching = std::max(kTouching, kPositionUlps * epsilon_);
  const auto touches = [&](const Eigen::Vector2d& centre) {
    return (position - centre).norm() < rho_ + touching;
  };
  if (!inward(centres[0])) return false;
  return std::none_of(centres.begin() + 1, centres.end(), [&](const Eigen::Vector2d& centre) {
    return touches(centre) && !inward(centre);
  });
}

}  // namespace ballpiston::stability
