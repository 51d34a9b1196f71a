#include "tools/conductivity/contact_matrix.h"

#include <cmath>

#include "tools/conductivity/gamma_law.h"

// With t = (v_a - v_b)^2/4, y = (v_a + v_b)^2/4 and the energies g of the other components,
//
//   e_a = (t + y)/2 + r + g_a,   e_b = (t + y)/2 - r + g_b,   r = sqrt(t y) before the exchange,
//
// and r has the other sign after it. v_a - v_b and v_a + v_b are independent normal variables, so
// y has the Gamma law of shape 1/2, and the weight (v_a - v_b)+ turns the law of t into that of
// shape 1. A difference f' - f is odd in r, so (f' - f)/r is a polynomial in t, y, g_a and g_b:
//
//   M(f, g) = (1/(4 sqrt(pi))) < (f' - f)/r (g' - g)/r >,   t of shape 2, y of shape 3/2:
//
// The factor t y = r^2 is included in the laws, and Gauss's quadrature is exact.
namespace ballpiston {
namespace {

// p_i(e_a) p_j(e_b) in the order of the rows.
Eigen::VectorXd PairProducts(SiteDimensions dimensions, int degree, double ea, double eb) {
  const Eigen::VectorXd a = GammaPolynomials(dimensions.a / 2.0, degree, ea);
  const Eigen::VectorXd b = GammaPolynomials(dimensions.b / 2.0, degree, eb);
  Eigen::VectorXd products(ContactRows(degree));
  for (int total = 0; total <= degree; ++total) {
    for (int j = 0; j <= total; ++j) {
      products[ContactRow(total - j, j)] = a[total - j] * b[j];
    }
  }
  return products;
}

// The quadrature of the energy in those components that the contact does not change.
GammaQuadrature OtherComponents(int dimension, int nodes) {
  if (dimension == 1) return {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  return GammaNodes((dimension - 1) / 2.0, nodes);
}

// (f' - f)/r of all products, a column for each node of g_a and g_b, times the root of its weight.
Eigen::MatrixXd Differences(SiteDimensions dimensions, int degree, double t, double y) {
  const GammaQuadrature ga = OtherComponents(dimensions.a, degree);
  const GammaQuadrature gb = OtherComponents(dimensions.b, degree);
  const double middle = (t + y) / 2, r = std::sqrt(t * y);
  Eigen::MatrixXd columns(ContactRows(degree), ga.nodes.size() * gb.nodes.size());
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < ga.nodes.size(); ++i) {
    for (Eigen::Index j = 0; j < gb.nodes.size(); ++j, ++column) {
      const double ea = middle + ga.nodes[i], eb = middle + gb.nodes[j];
      columns.col(column) = std::sqrt(ga.weights[i] * gb.weights[j]) / r *
                            (PairProducts(dimensions, degree, ea - r, eb + r) -
                             PairProducts(dimensions, degree, ea + r, eb - r));
    }
  }
  return columns;
}

}  // namespace

Eigen::MatrixXd ContactMatrix(SiteDimensions dimensions, int degree) {
  const GammaQuadrature t = GammaNodes(2, degree), y = GammaNodes(1.5, degree);
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(ContactRows(degree), ContactRows(degree));
  for (int i = 0; i < degree; ++i) {
    for (int j = 0; j < degree; ++j) {
      lower.selfadjointView<Eigen::Lower>().rankUpdate(
          Differences(dimensions, degree, t.nodes[i], y.nodes[j]),
          kContactRate / 4 * t.weights[i] * y.weights[j]);
    }
  }
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace ballpiston
