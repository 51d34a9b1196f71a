// The stochastic kernel of a pair with the total energy 1/2, and its moments: the rate density of
// collisions after which the piston has the energy ep_out, the rate of all collisions, the moments
// of the energy zeta = ep_out - ep that goes from the ball to the piston, and the fraction of the
// collisions after which the piston has less than a given energy.
//
//   W(ep -> ep_out) = max(sqrt ep_out, sqrt ep)/(2 pi sqrt(ep_out (eb - ep_out)))   eq. kernel
//   f(ep) = int W dzeta           rate of collisions           eq. intkernelnuf
//   j(ep) = int zeta W dzeta      energy current               eq. intkerneleta
//   h(ep) = int zeta^2 W dzeta    second moment of transfer    eq. intkerneleta2
//
//   F(ep_out) = int_0^ep_out W dx/f
//       = sqrt(ep) a/(p + q)                for ep_out <= ep,  a = arcsin sqrt(ep_out/eb)
//       = 1 - sqrt(eb - ep_out)/(p + q)     above,
//   p = sqrt(ep) arcsin sqrt(min(ep/eb, 1)),  q = sqrt(max(eb - ep, 0)),  f = (p + q)/pi
//
// W is 0 for ep_out >= eb: the piston's new energy is the energy of the ball's normal velocity
// component. At ep_out = 0 < ep it is infinite (and integrable). If W is the law of a collision,
// F(ep_out) is uniform on [0, 1] for all energies before it.
//
// Symbols: eb = 1/2 - ep and ep are the energies of ball and piston before the collision. For
// another total energy E the paper's functions of (eb, ep) follow from those of ep/(2 E): W, f, j
// and h times the powers -1/2, 1/2, 3/2 and 5/2 of 2 E. Units: |dG_bp|/|G| times these powers of
// energy. Domain: ep and ep_out in [0, 1/2].
//
// Properties, each with the test that bears its name:
//   1. AccurateAtRandomEnergies: relative error of W below kKernelRelativeError, also where the
//      ball keeps little energy (ep + ep_out -> 1/2).
//   2. MomentsAreAccurateForEveryEnergy: relative error of f, j and h below
//      kKernelMomentsRelativeError, also where j passes through its zero.
//   3. DistributionIsAccurateAtRandomEnergies: relative error of F, and of f computed with it,
//      below kKernelDistributionRelativeError, also where the ball keeps little energy.
//   4. DistributionRisesFromZeroToOne: F reaches 1 at ep_out = eb, and falls nowhere except by
//      rounding.
// The energy current j is positive exactly when ep/eb < 0.5404... Detailed balance: W(ep ->
// ep_out)/sqrt(ep) is symmetric in ep and ep_out, 1/sqrt(ep) being the microcanonical density.
//
// The distribution uses only +, -, *, /, sqrt and Atan2, so its bits are the same on every
// processor. Pure functions and an immutable object: safe from any thread.
#pragma once

namespace ballpiston {

inline constexpr double kKernelRelativeError = 1e-15;
inline constexpr double kKernelMomentsRelativeError = 1e-14;
inline constexpr double kKernelDistributionRelativeError = 2e-15;

double PairKernel(double ep, double ep_out);  // W
double PairCollisionRate(double ep);          // f
double PairEnergyCurrent(double ep);          // j
double PairSquaredEnergyTransfer(double ep);  // h

class KernelDistribution {
 public:
  explicit KernelDistribution(double ep);

  // f
  double CollisionRate() const;
  // F
  double Below(double ep_out) const;

 private:
  double eb_;      // the ball's energy,
  double eb_low_;  // and the remainder that its rounding dropped
  double ep_;
  double piston_speed_;  // sqrt(ep)
  double p_;
  double q_;
};

}  // namespace ballpiston
