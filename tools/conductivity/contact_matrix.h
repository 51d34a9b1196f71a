// The matrix of one contact's part of the jump process's generator, between products of polynomials
// of the two sites' energies.
//
// Two sites a and b have velocities of d_a and d_b components, which are isotropic at given
// energies. In a contact they exchange their components v_a and v_b along the contact, at the rate
// (v_a - v_b)+. In equilibrium at temperature 1 the energies are independent, with Gamma laws of
// shapes d_a/2 and d_b/2, and the contact's generator L is symmetric:
//
//   M(f, g) = -<f L g> = (1/2) < (v_a - v_b)+ (f' - f) (g' - g) >,        ' = after the exchange,
//
// with f, g products p_i(e_a) p_j(e_b) of the orthonormal polynomials of gamma_law.h.
//
// Units: masses and temperature 1; rates are those at a contact's density of 1, so the exchange
// rate is kContactRate. Domain: 1 <= d_a, d_b <= 100, 1 <= degree <= 40.
// Error: kContactMatrixError. Property, with the test that bears its name:
//   1. HighDegreesAreExactToRounding.
// Results from this matrix agree with markov/generator.h (chain_gap.h) and with a published value
// (conductivity.h).
#pragma once

#include <Eigen/Core>

#include "core/conductivity/conductivity.h"

namespace ballpiston {

// The largest error of an element, divided by the root of the product of two diagonal elements:
// those of its row and of its column.
inline constexpr double kContactMatrixError = 1e-13;

struct SiteDimensions {
  int a;
  int b;
};

// The row of p_i(e_a) p_j(e_b). Products of a lower total degree come first.
inline int ContactRow(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }
// The number of products of a total degree up to `degree`.
inline int ContactRows(int degree) { return ContactRow(degree + 1, 0); }

// M between all products of a total degree up to `degree`: symmetric, with ContactRows(degree) rows
// and columns.
Eigen::MatrixXd ContactMatrix(SiteDimensions dimensions, int degree);

}  // namespace ballpiston
