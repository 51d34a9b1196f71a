// The stochastic kernel's distribution function: the fraction of the collisions at given energies
// after which the piston has less than a given energy.
//
//   F(ep_out | eb, ep) = int_0^ep_out W(eb, ep -> x) dx / f(eb, ep)      eqs. kernel, intkernelnuf
//       = sqrt(ep) a / (p + q)                       for ep_out <= ep,  a = arcsin sqrt(ep_out/eb)
//       = 1 - sqrt(eb - ep_out) / (p + q)            above,
//   p = sqrt(ep) arcsin sqrt(min(ep/eb, 1)),  q = sqrt(max(eb - ep, 0)),  f = (p + q)/pi.
//
// If W is the law of a collision, F(ep_out) is uniform on [0, 1] for all energies before it.
//
// Symbols: eb and ep are the energies of ball and piston before the collision. Domain: eb and ep in
// [0, 1e290], eb of at least 1e-290 or 0; ep_out >= 0. F = 1 for ep_out >= eb. OfPair is F at total
// energy 1/2, and keeps the digits of eb = 1/2 - ep that rounding drops; ep in [0, 1/2].
//
// Properties, each with the test that bears its name:
//   1. AccurateAtRandomEnergies: relative error of F and of the rate below
//      kKernelDistributionRelativeError, also where the ball keeps little energy.
//   2. RisesFromZeroToOne: F reaches 1 at ep_out = eb, and falls nowhere except by rounding.
//   3. SlopeIsTheKernelOverItsRate.
// Uses only +, -, *, /, sqrt and Atan2, so the bits are the same on every processor.
//
// Immutable: safe to share between threads.
#pragma once

namespace ballpiston {

inline constexpr double kKernelDistributionRelativeError = 2e-15;

class KernelDistribution {
 public:
  KernelDistribution(double eb, double ep) : KernelDistribution(eb, 0, ep) {}
  static KernelDistribution OfPair(double ep);

  // f, in the units of kernel_moments.h.
  double CollisionRate() const;
  // F
  double Below(double ep_out) const;

 private:
  KernelDistribution(double eb, double eb_low, double ep);

  double eb_;      // the ball's energy,
  double eb_low_;  // and the remainder that its rounding dropped
  double ep_;
  double piston_speed_;  // sqrt(ep)
  double p_;
  double q_;
};

}  // namespace ballpiston
