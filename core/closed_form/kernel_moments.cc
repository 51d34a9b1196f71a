// Forms without loss of digits.
//
// Angle. With d = eb - ep the paper's arcsin sqrt(ep/eb) is atan2(sqrt ep, sqrt d). The arcsine has
// infinite slope at ep = eb, where the rounding of ep/eb would cost half of the digits.
//
// h. Its quadratic 3/8 eb^2 - eb ep + ep^2 is (ep - eb/2)^2 + eb^2/8, a sum of squares. Of the
// other terms only -(45/8) ep (eb - 2 ep) sqrt(d) is negative. Its size is below a fifth of the sum
// of the others, so there is no cancellation.
//
// j. With E = eb + ep and y = ep/E, j = E^(3/2) J(y), where for y < 1/2
//     6 pi J = (4 - 11 y) sqrt(1 - 2 y) + 3 (1 - 3 y) sqrt(y) atan2(sqrt y, sqrt(1 - 2 y)) .
// J has one simple zero, y0 = 0.3508..., near which this sum loses digits as 1/|y - y0|. For
// |y - y0| < kWindow the sum is replaced by its Taylor polynomial
//     J = t (J1 + J2 t + ... + J10 t^9),   t = y - y0,
// whose relative error is that of t. So t must be computed without rounding y:
//     at total energy 1/2     t = 2 ep - y0
//     in general              t = (ep - r0 eb)(1 - y0)/E,   r0 = y0/(1 - y0),
// with y0 and r0 as unevaluated sums of two doubles, and a fused product r0 eb. Outside of the
// window the error of the sum is 4e-15 (measured at the window's edge). Inside, the first omitted
// term is 1e-17 of J1 (the nearest singularity, y = 1/2, is at a distance of 0.149, nineteen
// windows).
//
// y0 is the root of J to 60 digits; J1...J10 are Taylor coefficients of J there, by numerical
// differentiation at 60 digits (mpmath's findroot and taylor), rounded to double. The tests do not
// use them: they compare with the printed formula in quadruple precision.
#include "core/closed_form/kernel_moments.h"

#include <cmath>
#include <numbers>

namespace ballpiston {
namespace {

using std::numbers::pi;

constexpr double kZeroHigh = 0x1.673def3edd2cdp-2;  // y0 = 0.35082219906989283744669...
constexpr double kZeroLow = 0x1.9e31939e61f62p-56;
constexpr double kRatioHigh = kCurrentZeroRatio;  // r0 = 0.54041003646035584060210...
constexpr double kRatioLow = 0x1.c462a9d5fc2e8p-55;
constexpr double kWindow = 0x1p-7;
constexpr double kCurrentTaylor[] = {  // J10 first
    -877.45540169481817414,  -204.70779479445854258,  -51.224594111926504110,
    -14.069196591425793994,  -4.3579515524347612211,  -1.5558690812937655993,
    -0.63880987628306893337, -0.27919700083435280982, 0.0062672804074613188138,
    -0.58359652745716563051};

// A division of the total energy, with differences that cannot be computed from the rounded
// energies.
struct EnergySplit {
  double eb;
  double ep;
  double excess;     // eb - ep
  double total;      // eb + ep
  double from_zero;  // ep/total - y0
};

EnergySplit Split(double eb, double ep) {
  const double total = eb + ep;
  const double beyond = std::fma(-kRatioHigh, eb, ep) - kRatioLow * eb;
  return {eb, ep, eb - ep, total, beyond * (1 - kZeroHigh) / total};
}

EnergySplit PairSplit(double ep) {
  return {0.5 - ep, ep, 0.5 - 2 * ep, 0.5, (2 * ep - kZeroHigh) - kZeroLow};
}

// arcsin sqrt(ep/eb), for eb > ep.
double SpeedAngle(const EnergySplit& e) { return std::atan2(std::sqrt(e.ep), std::sqrt(e.excess)); }

double CurrentNearZero(const EnergySplit& e) {
  double sum = 0;
  for (const double coefficient : kCurrentTaylor) sum = sum * e.from_zero + coefficient;
  return e.total * std::sqrt(e.total) * e.from_zero * sum;
}

double Rate(const EnergySplit& e) {
  if (e.excess <= 0) return std::sqrt(e.ep) / 2;
  return (std::sqrt(e.excess) + std::sqrt(e.ep) * SpeedAngle(e)) / pi;
}

double Current(const EnergySplit& e) {
  if (e.excess <= 0) return (e.eb - 2 * e.ep) * std::sqrt(e.ep) / 4;
  if (std::abs(e.from_zero) < kWindow) return CurrentNearZero(e);
  return ((4 * e.eb - 7 * e.ep) * std::sqrt(e.excess) +
          3 * (e.eb - 2 * e.ep) * std::sqrt(e.ep) * SpeedAngle(e)) /
         (6 * pi);
}

double SquaredTransfer(const EnergySplit& e) {
  const double offset = e.ep - e.eb / 2;
  const double quadratic = offset * offset + e.eb * e.eb / 8;
  if (e.excess <= 0) return std::sqrt(e.ep) * quadratic / 2;
  const double root = std::sqrt(e.excess);
  return (8 * e.excess * e.excess * root + 11.25 * e.ep * offset * root +
          15 * std::sqrt(e.ep) * quadratic * SpeedAngle(e)) /
         (15 * pi);
}

}  // namespace

double CollisionRate(double eb, double ep) { return Rate(Split(eb, ep)); }
double EnergyCurrent(double eb, double ep) { return Current(Split(eb, ep)); }
double SquaredEnergyTransfer(double eb, double ep) { return SquaredTransfer(Split(eb, ep)); }

double PairCollisionRate(double ep) { return Rate(PairSplit(ep)); }
double PairEnergyCurrent(double ep) { return Current(PairSplit(ep)); }
double PairSquaredEnergyTransfer(double ep) { return SquaredTransfer(PairSplit(ep)); }

}  // namespace ballpiston
