#include "core/sampling/outgoing_law.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {
namespace {

double IntegerPower(double base, uint64_t exponent) {
  double power = 1;
  for (; exponent != 0; exponent >>= 1, base *= base) {
    if (exponent & 1) power *= base;
  }
  return power;
}

// ball/(ball + piston)
double Share(double ball, double piston) { return ball / (ball + piston); }

}  // namespace

OutgoingLaw::OutgoingLaw(double epsilon, double exponent)
    : exponent_(exponent),
      ball_(Share(std::sqrt(0.5 - epsilon), std::sqrt(epsilon))),
      piston_(Share(std::sqrt(epsilon), std::sqrt(0.5 - epsilon))),
      // The weight grows with |x|, and d|alpha|/d|x| falls.
      steps_(-1, 1, [this](double a, double b) {
        return std::max(Weight(At(a)), Weight(At(b))) / (1 + std::min(a * a, b * b));
      }) {}

SignedDirection OutgoingLaw::At(double x) {
  const double scale = 1 / (1 + x * x);
  const double cosine = (1 - x * x) * scale, sine = 2 * std::fabs(x) * scale;  // of alpha/2
  return {.ball = {(cosine - sine) * (cosine + sine), 2 * cosine * sine}, .sigma = x < 0 ? -1 : 1};
}

double OutgoingLaw::Weight(const SignedDirection& direction) const {
  const double base = direction.sigma * piston_ - ball_ * direction.ball.x();
  if (base <= 0) return 0;
  // Most exponents are whole numbers, which need fewer operations.
  if (exponent_ == std::floor(exponent_)) {
    return IntegerPower(base, static_cast<uint64_t>(exponent_));
  }
  return Power(base, exponent_);
}

SignedDirection OutgoingLaw::Draw(CounterRandom& random) const {
  SignedDirection drawn;
  steps_.Draw(random, [&](double x) {
    drawn = At(x);
    return Weight(drawn) / (1 + x * x);
  });
  if ((random.Bits() >> 63) != 0) drawn.ball.y() = -drawn.ball.y();
  return drawn;
}

}  // namespace ballpiston
