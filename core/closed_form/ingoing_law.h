// The equilibrium law of the velocities with which ball and piston collide, at a given piston
// energy. The first-hit histograms are compared with this law.
//
//   h(alpha, sigma) = (sqrt(eb) cos alpha - sigma sqrt(ep))_+/N      eq. falpha with n = 1
//   N = 4 pi f(eb, ep)                                               eqs. cnuep, intkernelnuf
//
// Symbols: alpha in [-pi, pi] is the direction of the ball's velocity, 0 towards the piston;
// sigma = +1 or -1 is the sign of the piston's velocity, +1 away from the ball. eb = 1/2 - ep. Both
// are values before the collision. The outgoing law is the time reversal v -> -v of this law.
//
// For each sigma the permitted angles are |alpha| < AlphaMax(sigma), that is
// cos alpha > sigma sqrt(ep/eb). For ep >= 1/4 the piston is at least as fast as the ball: a piston
// with sigma = +1 never meets the ball, and with sigma = -1 every alpha is permitted.
//
// Domain: ep in [0, 1/2], sigma = +-1, -pi <= a0 <= a1 <= pi. Probabilities have no dimension.
//
// Properties, each with the test that bears its name:
//   1. BinProbabilityIsTheIntegralOfTheDensity, without cancellation on narrow bins and next to
//      AlphaMax.
//   2. OnlyThePermittedIntervalCounts, also in a bin that reaches beyond it.
//   3. IntervalsAndMeansAreThoseOfTheDensity: MeanCosAlpha = sqrt(eb)/(4 f),
//      MeanSigma = -sqrt(ep)/(2 f).
// At ep = 0 both signs have the same law, and at ep = 1/2 alpha is uniform.
//
// The error bound of a bin is relative and treats AlphaMax, a double, as exact. On a bin of width w
// at AlphaMax the rounding of AlphaMax changes the probability by a relative 1e-16/w.
//
// Immutable: safe to share between threads.
#pragma once

namespace ballpiston {

inline constexpr double kIngoingLawRelativeError = 2e-14;

class IngoingLaw {
 public:
  explicit IngoingLaw(double ep);

  // Half-width of the permitted interval of alpha: 0 if no angle is permitted, pi if all are.
  double AlphaMax(int sigma) const { return sigma > 0 ? alpha_max_plus_ : alpha_max_minus_; }

  double BinProbability(int sigma, double a0, double a1) const;
  double SigmaProbability(int sigma) const {
    return BinProbability(sigma, -AlphaMax(sigma), AlphaMax(sigma));
  }

  double MeanCosAlpha() const { return mean_cos_alpha_; }
  double MeanSigma() const { return mean_sigma_; }

 private:
  double Unnormalised(int sigma, double alpha) const;

  double ball_;    // sqrt(eb)
  double excess_;  // (sqrt(ep) - sqrt(eb))_+
  double alpha_max_plus_;
  double alpha_max_minus_;
  double normalisation_;  // N
  double mean_cos_alpha_;
  double mean_sigma_;
};

}  // namespace ballpiston
