// Accuracy. No step cancels: 1 - 2 u^2 is fused, s^2 = (1 - u)(1 + u), and for u' > u, with
// w = c v - u A in [0, q],
//     s^2 - (q - w)^2 = u^2 + w (2 q - w).
// w loses digits if it is much smaller than u A. The loss is at most a rounding of u^2, because
// then u A <= 2 u^2.
#include "core/markov/jump_process.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace ballpiston {
namespace {

double Target(double u, double q, double low, double v) {
  const double g = (q + low) * v;
  if (g < low) return std::sqrt((1 - u) * (1 + u)) * std::sin(g / u);
  const double w = std::fma(q + low, v, -low);
  return std::min(std::sqrt(std::fma(w, 2 * q - w, u * u)), 1.0);
}

}  // namespace

Jump JumpFrom(double u, double waiting_uniform, double target_uniform) {
  const double q = std::sqrt(std::max(std::fma(-2 * u, u, 1.0), 0.0));
  const double low = u * std::atan2(u, q);
  const double rate = (q + low) / (std::numbers::sqrt2 * std::numbers::pi);
  return {.waiting_time = -std::log(waiting_uniform) / rate,
          .u = Target(u, q, low, target_uniform)};
}

JumpWalkers::JumpWalkers(uint64_t seed, uint64_t stream, uint64_t first, std::vector<double> u)
    : seed_(seed), stream_(stream), first_(first), walkers_(u.size()), u_(std::move(u)) {
  assert(std::all_of(u_.begin(), u_.end(), [](double x) { return x >= 0 && x <= 1; }));
  words_.resize((walkers_ + kJumpGroup - 1) / kJumpGroup);
  u_.resize(words_.size() * kJumpGroup);
  times_.resize(u_.size());
}

// Philox makes the words of two jumps at once.
void JumpWalkers::Jump() {
  const size_t used = jumps_ % 2 * 2;
  for (size_t group = 0; group < words_.size(); ++group) {
    const size_t begin = group * kJumpGroup;
    auto& [words] = words_[group];
    if (used == 0) DrawJumpWords(seed_, stream_, first_ + begin, 1 + jumps_ / 2, words_[group]);
    JumpInLanes(words[used], words[used + 1], u_.data() + begin, times_.data() + begin);
  }
  ++jumps_;
}

}  // namespace ballpiston
