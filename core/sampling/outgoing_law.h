// The outgoing laws h^(n) of the paper's eq. falpha: after a ball-piston collision at fixed
// energies, the ball's angle alpha and the sign sigma of the piston's velocity have density
//   proportional to (sigma sqrt(ep) - sqrt(eb) cos alpha)_+^n,   eb = 1/2 - ep,
// which is the time reversal of the paper's ingoing form. n = 1 is the invariant law; n = 0 is
// uniform over the velocities that separate ball and piston. n is any real number in [0,
// kMaxExponent].
//
// Sampling is exact, by rejection from a step function of x, where |x| = tan(|alpha|/4) and x has
// the sign of sigma. So the functions of alpha are rational, and their bits are the same on every
// machine. Of the proposals at least three in four are accepted.
#pragma once

#include <Eigen/Core>

#include "core/sampling/counter_random.h"
#include "core/sampling/step_envelope.h"

namespace ballpiston {

struct SignedDirection {
  Eigen::Vector2d ball;  // (cos alpha, sin alpha)
  int sigma = 1;         // +1 or -1
};

class OutgoingLaw {
 public:
  // 0 <= epsilon <= 1/2, 0 <= exponent.
  OutgoingLaw(double epsilon, double exponent);

  SignedDirection Draw(CounterRandom& random) const;

 private:
  static SignedDirection At(double x);                    // with the ball's y >= 0
  double Weight(const SignedDirection& direction) const;  // at most 1

  double exponent_;
  double ball_;    // sqrt(eb)/(sqrt(eb) + sqrt(ep))
  double piston_;  // sqrt(ep)/(sqrt(eb) + sqrt(ep))
  StepEnvelope steps_;
};

}  // namespace ballpiston
