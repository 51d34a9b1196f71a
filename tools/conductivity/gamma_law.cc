#include "tools/conductivity/gamma_law.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace ballpiston {
namespace {

// sqrt(b_(k+1)) p_(k+1) = (x - a_k) p_k - sqrt(b_k) p_(k-1) for the orthonormal polynomials.
double RecurrenceA(double shape, int k) { return 2 * k + shape; }
double RecurrenceRootB(double shape, int k) { return std::sqrt(k * (k + shape - 1)); }

// The nodes are the eigenvalues of the matrix of the multiplication by x.
Eigen::VectorXd EigenvaluesOfRecurrence(double shape, int count) {
  Eigen::VectorXd diagonal(count), beside(count - 1);
  for (int k = 0; k < count; ++k) diagonal[k] = RecurrenceA(shape, k);
  for (int k = 1; k < count; ++k) beside[k - 1] = RecurrenceRootB(shape, k);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

}  // namespace

Eigen::VectorXd GammaPolynomials(double shape, int degree, double x) {
  Eigen::VectorXd p(degree + 1);
  p[0] = 1;
  if (degree > 0) p[1] = (x - shape) / RecurrenceRootB(shape, 1);
  for (int k = 1; k < degree; ++k) {
    p[k + 1] = ((x - RecurrenceA(shape, k)) * p[k] - RecurrenceRootB(shape, k) * p[k - 1]) /
               RecurrenceRootB(shape, k + 1);
  }
  return p;
}

// The weights are from Christoffel's formula, because eigenvectors give small weights less exactly.
GammaQuadrature GammaNodes(double shape, int count) {
  GammaQuadrature rule = {EigenvaluesOfRecurrence(shape, count), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    rule.weights[i] = 1 / GammaPolynomials(shape, count - 1, rule.nodes[i]).squaredNorm();
  }
  return rule;
}

}  // namespace ballpiston
