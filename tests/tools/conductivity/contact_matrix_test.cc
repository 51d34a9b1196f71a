#include "tools/conductivity/contact_matrix.h"

#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/conductivity/gamma_law.h"

namespace ballpiston {
namespace {

constexpr int kDegree = 6;

struct Point {
  double x;
  double weight;
};

// Gauss-Legendre nodes on [0, end].
std::vector<Point> Panels(int count, double end) {
  std::vector<Point> points;
  const double half = end / count / 2;
  for (int panel = 0; panel < count; ++panel) {
    for (const oracle::GaussNode& node : oracle::GaussNodes()) {
      points.push_back({(2 * panel + 1) * half + half * static_cast<double>(node.x),
                        half * static_cast<double>(node.weight)});
    }
  }
  return points;
}

// Nodes in the energy of `components` velocity components, from their speed's law.
std::vector<Point> EnergyPoints(int components, int panels) {
  if (components == 0) return {{0, 1}};
  std::vector<Point> points;
  const double norm = std::pow(2, components / 2.0 - 1) * std::tgamma(components / 2.0);
  for (const Point& v : Panels(panels, 14)) {
    const double density = std::pow(v.x, components - 1) * std::exp(-v.x * v.x / 2) / norm;
    points.push_back({v.x * v.x / 2, v.weight * density});
  }
  return points;
}

struct Element {
  int i, j, k, l;
};

// -<f L g> = -<(v_a - v_b)+ f (g' - g)>, integrated over velocities. This is equal to the symmetric
// form of the matrix only if the exchange satisfies detailed balance. v_a = mean + half and
// v_b = mean - half have the density exp(-mean^2 - half^2)/pi in mean and half.
std::vector<double> ByQuadrature(SiteDimensions d, const std::vector<Element>& elements,
                                 int panels) {
  const auto p = [d](double x) { return GammaPolynomials(d.a / 2.0, kDegree, x); };
  const auto q = [d](double x) { return GammaPolynomials(d.b / 2.0, kDegree, x); };
  std::vector<double> sums(elements.size());
  for (const Point& mean : Panels(panels, 10)) {
    for (const Point& half : Panels(panels, 10)) {
      for (const double sign : {-1, 1}) {
        const double va = sign * mean.x + half.x, vb = sign * mean.x - half.x;
        const double density =
            mean.weight * half.weight * std::exp(-(va * va + vb * vb) / 2) / std::numbers::pi;
        if (density < 1e-40) continue;
        for (const Point& a : EnergyPoints(d.a - 1, panels)) {
          const Eigen::VectorXd pa = p(a.x + va * va / 2), after_a = p(a.x + vb * vb / 2);
          for (const Point& b : EnergyPoints(d.b - 1, panels)) {
            const double rate = density * a.weight * b.weight * (va - vb);
            if (rate < 1e-40) continue;
            const Eigen::VectorXd qb = q(b.x + vb * vb / 2), after_b = q(b.x + va * va / 2);
            for (size_t n = 0; n < elements.size(); ++n) {
              const auto [i, j, k, l] = elements[n];
              sums[n] -= rate * pa[i] * qb[j] * (after_a[k] * after_b[l] - pa[k] * qb[l]);
            }
          }
        }
      }
    }
  }
  return sums;
}

double At(const ContactMatrix& matrix, const Element& e) {
  return matrix.elements()(ContactMatrix::Row(e.i, e.j), ContactMatrix::Row(e.k, e.l));
}

// The integrals of two equal sites have one dimension more, so they have lower degrees and fewer
// nodes.
TEST(ContactMatrix, AgreesWithAnIndependentQuadrature) {
  const std::vector<Element> elements = {{1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 1}, {2, 0, 0, 2},
                                         {2, 1, 1, 0}, {0, 3, 2, 1}, {3, 0, 3, 0}, {1, 2, 4, 0},
                                         {2, 2, 0, 1}, {4, 1, 1, 4}, {0, 5, 5, 0}, {3, 3, 1, 0},
                                         {6, 0, 0, 1}, {2, 4, 3, 2}};
  const std::vector<Element> of_equal_sites = {{1, 0, 1, 0}, {1, 0, 0, 1}, {2, 0, 1, 0},
                                               {1, 1, 1, 1}, {2, 1, 1, 0}, {1, 2, 0, 3},
                                               {2, 1, 3, 0}};
  for (const SiteDimensions d : {SiteDimensions{2, 1}, {1, 2}, {1, 3}, {1, 1}, {2, 2}, {3, 3}}) {
    const bool is_costly = d.a > 1 && d.b > 1;
    const std::vector<Element>& compared = is_costly ? of_equal_sites : elements;
    const ContactMatrix matrix(d, kDegree);
    const std::vector<double> exact = ByQuadrature(d, compared, is_costly ? 1 : 3);
    for (size_t n = 0; n < compared.size(); ++n) {
      EXPECT_NEAR(At(matrix, compared[n]), exact[n], is_costly ? 1e-9 : 1e-12)
          << d.a << " " << d.b << ": " << n;
    }
  }
}

// The elements of low degrees do not depend on the largest degree.
TEST(ContactMatrix, HighDegreesAreExactToRounding) {
  const auto differ = [](SiteDimensions d, int low_degree, int high_degree) {
    const Eigen::MatrixXd low = ContactMatrix(d, low_degree).elements();
    const Eigen::MatrixXd high =
        ContactMatrix(d, high_degree).elements().topLeftCorner(low.rows(), low.cols());
    const Eigen::VectorXd scale = low.diagonal().cwiseMax(1e-3).cwiseSqrt();
    return ((high - low).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
  };
  EXPECT_LE(differ({2, 1}, 12, 20), kContactMatrixError);
  EXPECT_LE(differ({2, 2}, 8, 12), kContactMatrixError);
}

}  // namespace
}  // namespace ballpiston
