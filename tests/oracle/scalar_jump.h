// A jump of the pair's jump process (core/markov/jump_process.h), computed with the C library: its
// definition, up to rounding. The lanes are compared with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ballpiston::oracle {

struct Jump {
  double waiting_time = 0;  // before the jump
  double u = 0;             // after the jump
};

inline double TargetOfJump(double u, double q, double low, double v) {
  const double g = (q + low) * v;
  if (g < low) return std::sqrt((1 - u) * (1 + u)) * std::sin(g / u);
  const double w = std::fma(q + low, v, -low);
  return std::min(std::sqrt(std::fma(w, 2 * q - w, u * u)), 1.0);
}

// u' grows with target_uniform.
inline Jump JumpFrom(double u, double waiting_uniform, double target_uniform) {
  const double q = std::sqrt(std::max(std::fma(-2 * u, u, 1.0), 0.0));
  const double low = u * std::atan2(u, q);
  const double rate = (q + low) / (std::numbers::sqrt2 * std::numbers::pi);
  return {.waiting_time = -std::log(waiting_uniform) / rate,
          .u = TargetOfJump(u, q, low, target_uniform)};
}

}  // namespace ballpiston::oracle
