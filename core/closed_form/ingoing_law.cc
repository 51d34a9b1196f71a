// Derivation. Write c = sqrt(eb), p = sqrt(ep), and A for AlphaMax(sigma).
//
// Density. If c > p then cos A = sigma p/c, and
//     c cos alpha - sigma p = c (cos alpha - cos A) = 2 c sin((A + alpha)/2) sin((A - alpha)/2),
// a product that keeps its digits where it vanishes. If c <= p, only sigma = -1 occurs, A = pi, and
//     c cos alpha + p = (p - c) + c (cos alpha - cos pi),
// the same product plus p - c = (ep - eb)/(p + c).
//
// Bins. Around the middle m of a bin of half-width w,
//     int (c cos alpha - sigma p) = 2 c cos(m) sin(w) - 2 sigma p w
//                                 = 2 w (c cos m - sigma p) - 2 c cos(m) (w - sin w),
// the density at the middle times the width, minus a correction of third order. For cos m > 0 the
// correction is at most half of the first term (for the whole circle, m = 0, w = A = pi); else it
// has the same sign as the first term.
//
// Means. Over both signs, the integrals of cos(alpha) times the density are c (A + sin A cos A) -
// 2 sigma p sin A. The two A add up to pi and their sines are equal, so the p terms cancel and the
// sum is pi c. Likewise the integrals of the density are 2 (c sin A - sigma p A), with the
// difference -2 pi p. (If c <= p, the single integral gives the same.) With N = 4 pi f both means
// follow.
#include "core/closed_form/ingoing_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/circular_segment.h"
#include "core/closed_form/kernel.h"

namespace ballpiston {

using std::numbers::pi;

IngoingLaw::IngoingLaw(double ep)
    : ball_(std::sqrt(0.5 - ep)),
      excess_(std::max(2 * ep - 0.5, 0.0) / (std::sqrt(ep) + ball_)),
      alpha_max_plus_(Atan2(std::sqrt(std::max(0.5 - 2 * ep, 0.0)), std::sqrt(ep))),
      alpha_max_minus_(pi - alpha_max_plus_),
      normalisation_(4 * pi * PairCollisionRate(ep)),
      mean_cos_alpha_(pi * ball_ / normalisation_),
      mean_sigma_(-2 * pi * std::sqrt(ep) / normalisation_) {}

double IngoingLaw::Unnormalised(int sigma, double alpha) const {
  const double edge = AlphaMax(sigma);
  const double arc = 2 * ball_ * std::sin((edge + alpha) / 2) * std::sin((edge - alpha) / 2);
  return sigma > 0 ? arc : excess_ + arc;
}

double IngoingLaw::BinProbability(int sigma, double a0, double a1) const {
  const double edge = AlphaMax(sigma);
  const double low = std::max(a0, -edge);
  const double high = std::min(a1, edge);
  if (!(low < high)) return 0;
  const double middle = low / 2 + high / 2;
  const double half = (high - low) / 2;
  const double integral =
      2 * half * Unnormalised(sigma, middle) - 2 * ball_ * std::cos(middle) * AngleMinusSine(half);
  return integral / normalisation_;
}

}  // namespace ballpiston
