#include "core/sampling/outgoing_law.h"

#include <cmath>
#include <cstdint>

#include "core/arithmetic/elementary_functions.h"
#include "core/sampling/direction.h"

namespace ballpiston {
namespace {

double IntegerPower(double base, uint64_t exponent) {
  double power = 1;
  for (; exponent != 0; exponent >>= 1, base *= base) {
    if (exponent & 1) power *= base;
  }
  return power;
}

}  // namespace

OutgoingLaw::OutgoingLaw(double epsilon, double exponent) : exponent_(exponent) {
  const double ball = std::sqrt(0.5 - epsilon), piston = std::sqrt(epsilon);
  ball_ = ball / (ball + piston);
  piston_ = piston / (ball + piston);
}

double OutgoingLaw::Weight(double base) const {
  // Most exponents are whole numbers, which need fewer operations.
  if (exponent_ == std::floor(exponent_)) {
    return IntegerPower(base, static_cast<uint64_t>(exponent_));
  }
  return Power(base, exponent_);
}

SignedDirection OutgoingLaw::Draw(CounterRandom& random) const {
  for (;;) {
    const SignedDirection proposal = {.ball = UniformDirection(random),
                                      .sigma = (random.Bits() >> 63) != 0 ? 1 : -1};
    const double base = proposal.sigma * piston_ - ball_ * proposal.ball.x();
    if (base > 0 && random.Uniform() <= Weight(base)) return proposal;
  }
}

}  // namespace ballpiston
