// Forms without loss of digits.
//
// Angle. arcsin sqrt(x/eb) is atan2(sqrt x, sqrt(eb - x)), whose slope is finite at x = eb.
//
// Above ep. The two terms of 1 - sqrt(eb - ep_out)/(p + q) cancel if ep and ep_out are much smaller
// than eb. With q - sqrt(eb - ep_out) = (ep_out - ep)/(q + sqrt(eb - ep_out)) the numerator is a
// sum of positive terms,
//     p + (ep_out - ep)/(q + sqrt(eb - ep_out)) .
// This needs eb > ep; otherwise ep_out <= eb <= ep.
#include "core/closed_form/kernel_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {
namespace {

// arcsin sqrt(part/(part + rest))
double SpeedAngle(double part, double rest) {
  return Atan2(std::sqrt(part), std::sqrt(std::max(rest, 0.0)));
}

}  // namespace

KernelDistribution::KernelDistribution(double eb, double eb_low, double ep)
    : eb_(eb), eb_low_(eb_low), ep_(ep), piston_speed_(std::sqrt(ep)) {
  const double excess = std::max((eb - ep) + eb_low, 0.0);
  q_ = std::sqrt(excess);
  p_ = piston_speed_ * (excess > 0 ? SpeedAngle(ep, excess) : std::numbers::pi / 2);
}

KernelDistribution KernelDistribution::OfPair(double ep) {
  const double eb = 0.5 - ep;
  return {eb, (0.5 - eb) - ep, ep};
}

double KernelDistribution::CollisionRate() const { return (p_ + q_) / std::numbers::pi; }

double KernelDistribution::Below(double ep_out) const {
  const double rest = (eb_ - ep_out) + eb_low_;
  if (rest <= 0) return 1;
  const double below = ep_out <= ep_ ? piston_speed_ * SpeedAngle(ep_out, rest)
                                     : p_ + (ep_out - ep_) / (q_ + std::sqrt(rest));
  return std::min(below / (p_ + q_), 1.0);
}

}  // namespace ballpiston
