// The ball-piston pair's geometry: a validated (rho, delta) and the lengths that follow from it.
//
// Unit cell [-1/2, 1/2]^2 with discs of radius rho at its corners; the ball lives between them.
// lambda = sqrt(4 rho^2 - 1) is the length of the interval between two intersections of
// neighbouring discs, so the cell's right tip lies at (1/2 - lambda/2, 0). The piston, a vertical
// segment of height eta, moves in [1/2 - lambda/2 - delta, 1/2 + lambda/2 + delta].
//
// delta has two bounds. For a single pair the closed forms hold up to (1 - lambda)/2, where the
// piston reaches the cell's middle. In a gas pistons must not overlap; this gives the paper's bound
// rho/sqrt(2) - lambda/2 (eq. x1x2x3 and the footnote before it).
//
// Near the right tip the outline of the cell is a function of the depth t = tip - x. With
// rho^2 = (1 + lambda^2)/4 the arcs above and below are at |y| = t (t + lambda)/(1/2 + s), where
// s = sqrt(rho^2 - (lambda/2 + t)^2) is the height of the discs' centres above their arcs.
//
// Lengths are in cells. All members are accurate to a few ulps over the whole domain.
// Immutable, so safe to share between threads.
#pragma once

#include "absl/status/statusor.h"

namespace ballpiston {

// Domain of the disc radius; both ends are excluded. The cell's tips become cusps at 1/2, and the
// cell vanishes at 1/sqrt(2).
inline constexpr double kMinRho = 0.5;
inline constexpr double kMaxRho = 0.70710678118654752440;

// sqrt(4 rho^2 - 1). Domain: kMinRho < rho < kMaxRho.
double Lambda(double rho);

// (1 - lambda)/2, the largest delta of a pair. Same domain.
double PairDeltaBound(double rho);

// rho/sqrt(2) - lambda/2, the largest delta of a gas. Same domain.
double GasDeltaBound(double rho);

// A delta above its bound by at most this relative amount is accepted and set to the bound, because
// both users and the computer round the bounds.
inline constexpr double kDeltaSlack = 1e-12;

class PairGeometry {
 public:
  // INVALID_ARGUMENT, with name, value and permitted range, unless kMinRho < rho < kMaxRho and
  // 0 < delta <= PairDeltaBound(rho) (1 + kDeltaSlack).
  static absl::StatusOr<PairGeometry> Create(double rho, double delta);

  double rho() const { return rho_; }
  double delta() const { return delta_; }
  double lambda() const { return lambda_; }
  double tip() const { return tip_; }                     // x of the cell's right tip
  double piston_left() const { return piston_left_; }     // leftmost position of the piston
  double piston_right() const { return piston_right_; }   // rightmost position of the piston
  double stroke() const { return lambda_ + 2 * delta_; }  // piston_right - piston_left

  // s at a depth of 0 to (1 - lambda)/2; 0 if rounding makes the depth larger.
  double CentreToArc(double depth) const;
  // Half the height of the cell, |y|, at the same depths. At the depth delta it is half the
  // piston's height, eta/2.
  double HalfHeight(double depth) const;

 private:
  PairGeometry(double rho, double delta);

  double rho_;
  double delta_;
  double lambda_;
  double tip_;
  double piston_left_;
  double piston_right_;
};

// OK, or the error that Create would return. For callers that collect all violations.
absl::Status ValidateRho(double rho);
absl::Status ValidatePairDelta(double rho, double delta);  // rho has to be valid
absl::Status ValidateGasDelta(double rho, double delta);   // likewise
absl::Status ValidatePositiveDelta(double delta);  // without a rho: the other bound needs it

}  // namespace ballpiston
