// Polynomials and Gauss's quadrature of the Gamma law, whose density at x > 0 is
// x^(shape-1) exp(-x)/Gamma(shape). It is the law of a site's energy at temperature 1, with shape
// d/2 for a site with d degrees of freedom. Its orthogonal polynomials are Laguerre's, with
// alpha = shape - 1.
//
// Domain: shape > 0, degree and nodes 1 to 100. The relative error of a mean is below 1e-12.
#pragma once

#include <Eigen/Core>

namespace ballpiston {

struct GammaQuadrature {
  Eigen::VectorXd nodes;
  Eigen::VectorXd weights;  // their sum is 1
};

// Mean values of polynomials of a degree up to 2 count - 1.
GammaQuadrature GammaNodes(double shape, int count);

// The orthonormal polynomials of degree 0 ... degree at x; their leading coefficients are positive.
Eigen::VectorXd GammaPolynomials(double shape, int degree, double x);

}  // namespace ballpiston
