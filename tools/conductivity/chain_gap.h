// The spectral gap of a chain in the limit of rare collisions: the slowest rate at which the
// energies of balls and pistons in a row relax to equilibrium.
//
// The chain has free ends, and its total energy S is fixed. In equilibrium the energies divided by
// S have Dirichlet's law. The generator acts between the polynomials of the energies of a total
// degree up to `degree`. Its least eigenvalue above 0 is an upper bound of the gap, and falls as
// the degree grows.
//
// The contact matrices are those of independent Gamma laws, where S is random. A polynomial y_q
// that is orthogonal to all those of lower degree under Dirichlet's law is S^q times a function of
// the energies over S. It is a combination of products of Gamma polynomials of degree q that the
// lowering operator sum(e d^2/de^2 + (d/2) d/de) maps to 0. A contact's rates grow as sqrt S, so
// with the Gamma law of S, of shape a = sum(d/2),
//
//   <y_q, L y_r> at S = 1:   <S^q y_q, L S^r y_r> / <S^(q + r + 1/2)>,   <y_q, y_q>:
//   <...>/<S^(2q)>.
//
// Units: rates |dG_bp|/|G| of the pair, S = 1/6 for each degree of freedom, so the pair's gap is
// that of markov/generator.h. Domain: 2 or more sites of 1 or more velocity components, degree 1 to
// 40; the cost grows as the cube of the number of polynomials, (n + N - 1)!/(n! (N - 1)!) with
// degree n and N sites. Properties, each with the test that bears its name:
//   1. GapOfThePairMatchesItsGenerator.  2. ChainsHaveTheirDocumentedGaps.
// The gap falls with the degree.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/conductivity/tail_limit.h"

namespace ballpiston {

// Eigenvalues of -L on the polynomials of a degree from 1 to `degree`, ascending; the first is the
// bound of the gap. `dimensions` are those of the sites' velocities: 2 for a ball, 1 for a piston.
Eigen::VectorXd ChainRates(const std::vector<int>& dimensions, int degree);

struct ComputedGap {
  BoundedValue gap;
  std::vector<double> bounds;  // by degree
};

// The gap, extrapolated from two or more ascending degrees.
ComputedGap ChainGap(const std::vector<int>& dimensions, const std::vector<int>& degrees);

}  // namespace ballpiston
