// Forms without loss of digits.
//
// Angle. With d = eb - ep the paper's arcsin sqrt(ep/eb) is atan2(sqrt ep, sqrt d). The arcsine has
// infinite slope at ep = eb, where the rounding of ep/eb would cost half of the digits.
//
// h. Its quadratic 3/8 eb^2 - eb ep + ep^2 is (ep - eb/2)^2 + eb^2/8, a sum of squares. Of the
// other terms only -(45/8) ep (eb - 2 ep) sqrt(d) is negative. Its size is below a fifth of the sum
// of the others, so there is no cancellation.
//
// j. With y = 2 ep, j = 2^(-3/2) J(y), where for y < 1/2
//     6 pi J = (4 - 11 y) sqrt(1 - 2 y) + 3 (1 - 3 y) sqrt(y) atan2(sqrt y, sqrt(1 - 2 y)) .
// J has one simple zero, y0 = 0.3508..., near which this sum loses digits as 1/|y - y0|. For
// |y - y0| < kWindow the sum is replaced by its Taylor polynomial
//     J = t (J1 + J2 t + ... + J10 t^9),   t = y - y0,
// whose relative error is that of t. So y0 is an unevaluated sum of two doubles. Outside of the
// window the error of the sum is 4e-15 (measured at the window's edge). Inside, the first omitted
// term is 1e-17 of J1 (the nearest singularity, y = 1/2, is at a distance of 0.149, nineteen
// windows).
//
// y0 is the root of J to 60 digits; J1...J10 are Taylor coefficients of J there, by numerical
// differentiation at 60 digits (mpmath's findroot and taylor), rounded to double. The tests do not
// use them: they compare with the printed formula in quadruple precision.
//
// F. arcsin sqrt(x/eb) is atan2(sqrt x, sqrt(eb - x)), as above. Above ep the two terms of
// 1 - sqrt(eb - ep_out)/(p + q) cancel if ep and ep_out are much smaller than eb. With
// q - sqrt(eb - ep_out) = (ep_out - ep)/(q + sqrt(eb - ep_out)) the numerator is a sum of positive
// terms,
//     p + (ep_out - ep)/(q + sqrt(eb - ep_out)) .
// This needs eb > ep; otherwise ep_out <= eb <= ep.
#include "core/closed_form/kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {
namespace {

using std::numbers::pi;

constexpr double kZeroHigh = 0x1.673def3edd2cdp-2;  // y0 = 0.35082219906989283744669...
constexpr double kZeroLow = 0x1.9e31939e61f62p-56;
constexpr double kWindow = 0x1p-7;
constexpr double kCurrentTaylor[] = {  // J10 first
    -877.45540169481817414,  -204.70779479445854258,  -51.224594111926504110,
    -14.069196591425793994,  -4.3579515524347612211,  -1.5558690812937655993,
    -0.63880987628306893337, -0.27919700083435280982, 0.0062672804074613188138,
    -0.58359652745716563051};

// 1/2 - ep - ep_out. Both steps are exact if the result is small, except that 1/2 - larger can lose
// the last bit of a number below 1/4; this bit is added again.
double Rest(double ep, double ep_out) {
  const double larger = std::max(ep, ep_out);
  const double smaller = std::min(ep, ep_out);
  const double rest = 0.5 - larger;
  const double dropped = (0.5 - rest) - larger;
  return (rest - smaller) + dropped;
}

// eb - ep, without the rounding of eb.
double Excess(double ep) { return 0.5 - 2 * ep; }

// arcsin sqrt(ep/eb), for eb > ep. By std::atan2, because no count depends on the moments' last
// bit; F, which sorts energies into bins, uses Atan2.
double SpeedAngle(double ep) { return std::atan2(std::sqrt(ep), std::sqrt(Excess(ep))); }

double CurrentNearZero(double from_zero) {
  double sum = 0;
  for (const double coefficient : kCurrentTaylor) sum = sum * from_zero + coefficient;
  return 0.5 * std::sqrt(0.5) * from_zero * sum;
}

// arcsin sqrt(part/(part + rest))
double AngleOfPart(double part, double rest) {
  return Atan2(std::sqrt(part), std::sqrt(std::max(rest, 0.0)));
}

}  // namespace

double PairKernel(double ep, double ep_out) {
  const double rest = Rest(ep, ep_out);
  if (rest <= 0) return 0;
  // max(sqrt ep_out, sqrt ep)/sqrt(ep_out), without 0/0 when both vanish. ep/ep_out may overflow.
  const double ratio = ep_out >= ep ? 1 : std::sqrt(ep) / std::sqrt(ep_out);
  return ratio / (2 * pi * std::sqrt(rest));
}

double PairCollisionRate(double ep) {
  if (Excess(ep) <= 0) return std::sqrt(ep) / 2;
  return (std::sqrt(Excess(ep)) + std::sqrt(ep) * SpeedAngle(ep)) / pi;
}

double PairEnergyCurrent(double ep) {
  const double eb = 0.5 - ep, from_zero = (2 * ep - kZeroHigh) - kZeroLow;
  if (Excess(ep) <= 0) return (eb - 2 * ep) * std::sqrt(ep) / 4;
  if (std::abs(from_zero) < kWindow) return CurrentNearZero(from_zero);
  return ((4 * eb - 7 * ep) * std::sqrt(Excess(ep)) +
          3 * (eb - 2 * ep) * std::sqrt(ep) * SpeedAngle(ep)) /
         (6 * pi);
}

double PairSquaredEnergyTransfer(double ep) {
  const double eb = 0.5 - ep, excess = Excess(ep), offset = ep - eb / 2;
  const double quadratic = offset * offset + eb * eb / 8;
  if (excess <= 0) return std::sqrt(ep) * quadratic / 2;
  const double root = std::sqrt(excess);
  return (8 * excess * excess * root + 11.25 * ep * offset * root +
          15 * std::sqrt(ep) * quadratic * SpeedAngle(ep)) /
         (15 * pi);
}

KernelDistribution::KernelDistribution(double ep)
    : eb_(0.5 - ep), eb_low_((0.5 - eb_) - ep), ep_(ep), piston_speed_(std::sqrt(ep)) {
  const double excess = std::max((eb_ - ep) + eb_low_, 0.0);
  q_ = std::sqrt(excess);
  p_ = piston_speed_ * (excess > 0 ? AngleOfPart(ep, excess) : pi / 2);
}

double KernelDistribution::CollisionRate() const { return (p_ + q_) / pi; }

double KernelDistribution::Below(double ep_out) const {
  const double rest = (eb_ - ep_out) + eb_low_;
  if (rest <= 0) return 1;
  const double below = ep_out <= ep_ ? piston_speed_ * AngleOfPart(ep_out, rest)
                                     : p_ + (ep_out - ep_) / (q_ + std::sqrt(rest));
  return std::min(below / (p_ + q_), 1.0);
}

}  // namespace ballpiston
