#include "core/billiard/tangent_plane.h"

#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {

void TangentPlane::Collide(const Collision& collision) {
  const bool is_odd = ((collision.ball_wall_hits ^ collision.piston_wall_hits) & 1) != 0;
  Wait(collision.state.ball_speed, collision.time, is_odd ? -1 : 1);
  Exchange(collision.state);
}

std::array<double, TangentPlane::kExponents> TangentPlane::TakeGrowth() {
  return std::exchange(growth_, {});
}

// Let y1 and y2 be the ball's parts after the wait, divided by 2^exponent, with y1 = m (unit
// vector) and y2 = alpha (unit vector) + ...; n1 and n2 the piston's parts; `shrink` = 2^-exponent.
// Then the first vector has the length r 2^exponent with r^2 = m^2 + (shrink |n1|)^2, and
//   second - share first,   share = (m alpha + shrink^2 n1.n2)/r^2,
// has the component shrink (alpha |n1|^2 - m n1.n2)/r^2 along y1, and across it, by the
// determinant, shrink (x1 x x2)/m, x1 and x2 being the ball's parts before the wait.
void TangentPlane::Wait(double ball_speed, double time, double sign) {
  auto& [first, second] = tangents_;
  const double at = flights_.at / ball_speed, ta = flights_.ta * ball_speed;
  const double shrink = std::ldexp(1.0, -static_cast<int>(std::fmin(flights_.exponent, 2000)));
  const double cross = first.a * second.A - first.A * second.a;
  const double y1a = flights_.aa * first.a + at * first.A;
  const double y1A = ta * first.a + flights_.tt * first.A;
  const double y2a = flights_.aa * second.a + at * second.A;
  const double y2A = ta * second.a + flights_.tt * second.A;
  const double m = std::sqrt(y1a * y1a + y1A * y1A);
  const double ua = y1a / m, uA = y1A / m;
  const double alpha = ua * y2a + uA * y2A;
  const double b1 = sign * (first.b + time * first.B), B1 = sign * first.B;
  const double b2 = sign * (second.b + time * second.B), B2 = sign * second.B;
  const double n11 = b1 * b1 + B1 * B1, n12 = b1 * b2 + B1 * B2;
  const double r_squared = m * m + shrink * shrink * n11;
  const double share = (m * alpha + shrink * shrink * n12) / r_squared;
  const double along = shrink * (alpha * n11 - m * n12) / r_squared;
  const double across = shrink * cross / m;
  const double b = b2 - share * b1, B = B2 - share * B1;
  const double r1 = std::sqrt(r_squared);
  const double r2 = std::sqrt(along * along + across * across + b * b + B * B);
  growth_[0] += Log(r1) + flights_.exponent * std::numbers::ln2;
  growth_[1] += Log(r2);
  const double of_piston = shrink / r1;
  first = {y1a / r1, y1A / r1, b1 * of_piston, B1 * of_piston};
  second = {(along * ua - across * uA) / r2, (along * uA + across * ua) / r2, b / r2, B / r2};
}

void TangentPlane::Exchange(const PairState& before) {
  const double c = before.piston_velocity * before.direction.x(), s = before.direction.y();
  const double length = std::sqrt(c * c + s * s);
  const double cosine = c / length, sine = s / length;
  for (auto& [a, A, b, B] : tangents_) {
    std::tie(a, b) = std::pair(cosine * a + sine * b, sine * a - cosine * b);
    std::tie(A, B) = std::pair(cosine * A + sine * B, sine * A - cosine * B);
  }
}

}  // namespace ballpiston
