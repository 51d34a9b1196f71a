// The paper's formulas as printed, one expression each, in any arithmetic. In double they are the
// naive evaluation, which core/closed_form improves. In quadruple precision they are the reference
// values, as long as 34 digits are enough despite the cancellation. Only tests and the stability
// tables use them.
//
// Rates, moments and the kernel are in units of |dG_bp|/|G|, as in the library.
#pragma once

#include <algorithm>
#include <cmath>

namespace ballpiston {

template <typename Real>
struct PrintedMeasures {
  Real lambda;
  Real eta;
  Real cell_area;         // eq. areax1x2
  Real volume;            // eq. Gv
  Real area_ball_piston;  // eq. dGc
  Real area_ball_wall;    // eq. dGb
  Real area_piston_wall;  // eq. dGpw
};

template <typename Real>
PrintedMeasures<Real> MeasuresAsPrinted(Real rho, Real delta, Real pi) {
  using std::asin, std::atan, std::sqrt;
  const Real sqrt2 = sqrt(Real{2});
  PrintedMeasures<Real> m;
  const Real l = m.lambda = sqrt(4 * rho * rho - 1);
  const Real stroke = l + 2 * delta;
  const Real root = sqrt(1 - 4 * delta * (l + delta));
  const Real angles = atan(l) - atan(stroke / root);
  m.eta = 1 - 2 * sqrt(rho * rho - (l / 2 + delta) * (l / 2 + delta));
  m.cell_area = 1 - l - rho * rho * (pi - 4 * atan(l));
  m.volume =
      stroke * m.cell_area -
      (2 * delta * (l + 4 * delta) + (1 - root) * (2 + 4 * delta * (l + delta) + 3 * l * l)) / 24 -
      rho * rho * stroke * angles / 2;
  m.area_ball_piston = (stroke * (2 - root) - l) / (2 * sqrt2) + sqrt2 * rho * rho * angles;
  m.area_ball_wall =
      rho * stroke *
          (8 * asin((1 - l) / (2 * sqrt2 * rho)) - asin(stroke / (2 * rho)) + asin(l / (2 * rho))) +
      rho * (1 - root);
  m.area_piston_wall = 2 * m.cell_area - m.area_ball_piston / sqrt2;
  return m;
}

// Eq. intkernelnuf.
template <typename Real>
Real CollisionRateAsPrinted(Real eb, Real ep, Real pi) {
  using std::asin, std::sqrt;
  if (eb <= ep) return sqrt(ep) / 2;
  return (sqrt(eb - ep) + sqrt(ep) * asin(sqrt(ep / eb))) / pi;
}

// Eq. intkerneleta.
template <typename Real>
Real EnergyCurrentAsPrinted(Real eb, Real ep, Real pi) {
  using std::asin, std::sqrt;
  if (eb <= ep) return (eb - 2 * ep) * sqrt(ep) / 4;
  return ((4 * eb - 7 * ep) * sqrt(eb - ep) + 3 * (eb - 2 * ep) * sqrt(ep) * asin(sqrt(ep / eb))) /
         (6 * pi);
}

// Eq. intkerneleta2.
template <typename Real>
Real SquaredTransferAsPrinted(Real eb, Real ep, Real pi) {
  using std::asin, std::sqrt;
  const Real quadratic = 3 * eb * eb / 8 - eb * ep + ep * ep;
  if (eb <= ep) return sqrt(ep) * quadratic / 2;
  const Real d = eb - ep;
  return (8 * d * d * sqrt(d) + 15 * (-3 * ep * (eb - 2 * ep) * sqrt(d) / 8 +
                                      sqrt(ep) * quadratic * asin(sqrt(ep / eb)))) /
         (15 * pi);
}

// Eq. kernel.
template <typename Real>
Real KernelAsPrinted(Real eb, Real ep, Real ep_out, Real pi) {
  using std::sqrt;
  if (ep_out >= eb) return 0;
  return std::max(sqrt(ep_out), sqrt(ep)) / (2 * pi * sqrt(ep_out * (eb - ep_out)));
}

}  // namespace ballpiston
