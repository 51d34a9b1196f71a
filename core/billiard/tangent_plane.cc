#include "core/billiard/tangent_plane.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {
namespace {

// (a, A) after the ball's flights, without the factor 2^exponent.
Eigen::Vector2d AfterFlights(const BallMap& flights, const Eigen::Vector2d& ball,
                             double ball_speed) {
  const auto& [aa, at, ta, tt, exponent] = flights;
  return {aa * ball[0] + at / ball_speed * ball[1], ta * ball_speed * ball[0] + tt * ball[1]};
}

}  // namespace

void TangentPlane::Collide(const Collision& collision) {
  const bool is_odd = ((collision.ball_wall_hits ^ collision.piston_wall_hits) & 1) != 0;
  Wait(collision.flights, collision.state.ball_speed, collision.time, is_odd ? -1 : 1);
  Exchange(collision.state);
}

std::array<double, TangentPlane::kExponents> TangentPlane::TakeGrowth() {
  return std::exchange(growth_, {});
}

// After the wait the vectors are (2^exponent y1, n1) and (2^exponent y2, n2). With y1 = m u, u of
// length 1, and h = 2^-exponent the first one has the length 2^exponent r, r^2 = m^2 + h^2 n1.n1.
// Let alpha = u.y2. The second vector less its share of the first,
//   share = (m alpha + h^2 n1.n2)/r^2,
// has the parts n2 - share n1 and, along u and across it,
//   h (alpha n1.n1 - m n1.n2)/r^2   and   h (x1 x x2)/m,
// the latter because the determinant of the flights is 1: x1 and x2 are (a, A) before the wait.
void TangentPlane::Wait(const BallMap& flights, double ball_speed, double time, double sign) {
  auto& [first, second] = tangents_;
  const double h = std::ldexp(1.0, -static_cast<int>(std::fmin(flights.exponent, 2000)));
  const double cross = first.ball[0] * second.ball[1] - first.ball[1] * second.ball[0];
  const Eigen::Vector2d y1 = AfterFlights(flights, first.ball, ball_speed);
  const Eigen::Vector2d y2 = AfterFlights(flights, second.ball, ball_speed);
  for (Tangent& tangent : tangents_) {
    tangent.both[0] += time * tangent.both[1];
    tangent.both *= sign;
  }
  const Eigen::Vector2d &n1 = first.both, &n2 = second.both;
  const double m = y1.norm();
  const Eigen::Vector2d u = y1 / m;
  const double alpha = u.dot(y2), n1_n1 = n1.squaredNorm(), n1_n2 = n1.dot(n2);
  const double r_squared = m * m + h * h * n1_n1, r = std::sqrt(r_squared);
  const double share = (m * alpha + h * h * n1_n2) / r_squared;
  const double along = h * (alpha * n1_n1 - m * n1_n2) / r_squared, across = h * cross / m;
  second = {along * u + across * Eigen::Vector2d(-u[1], u[0]), n2 - share * n1};
  const double rest = std::sqrt(second.ball.squaredNorm() + second.both.squaredNorm());
  second = {second.ball / rest, second.both / rest};
  first = {y1 / r, n1 * (h / r)};
  growth_[0] += Log(r) + flights.exponent * std::numbers::ln2;
  growth_[1] += Log(rest);
}

void TangentPlane::Exchange(const PairState& before) {
  const double p_cos = before.piston_velocity * before.direction.x(), sin = before.direction.y();
  const double length = std::sqrt(p_cos * p_cos + sin * sin);
  const double c = p_cos / length, s = sin / length;
  for (auto& [ball, both] : tangents_) {
    const Eigen::Vector2d before_exchange = ball;
    ball = c * ball + s * both;
    both = s * before_exchange - c * both;
  }
}

}  // namespace ballpiston
