#include "core/conductivity/contact_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/conductivity/gamma_law.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

constexpr SiteDimensions kAllDimensions[] = {{2, 1}, {1, 2}, {2, 2}, {3, 3}, {1, 1}};

// Laguerre's polynomial by its sum, normalised, with a positive leading coefficient.
double OrthonormalLaguerre(double shape, int n, double x) {
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    sum += std::exp(std::lgamma(n + shape) - std::lgamma(n - i + 1) - std::lgamma(shape + i) -
                    std::lgamma(i + 1)) *
           std::pow(-x, i);
  }
  const double square = std::exp(std::lgamma(n + shape) - std::lgamma(n + 1) - std::lgamma(shape));
  return (n % 2 == 0 ? sum : -sum) / std::sqrt(square);
}

struct Point {
  double x;
  double weight;
};

// Gauss-Legendre nodes on [0, 12], whose end a velocity does not reach: exp(-72).
std::vector<Point> Panels(int count) {
  constexpr double kEnd = 12;
  std::vector<Point> points;
  for (int panel = 0; panel < count; ++panel) {
    const double half = kEnd / count / 2;
    for (const oracle::GaussNode& node : oracle::GaussNodes()) {
      points.push_back({(2 * panel + 1) * half + half * static_cast<double>(node.x),
                        half * static_cast<double>(node.weight)});
    }
  }
  return points;
}

double NormalDensity(double v) { return std::exp(-v * v / 2) / std::sqrt(2 * std::numbers::pi); }

// Nodes in the energy of `components` velocity components, from their speed's law.
std::vector<Point> EnergyPoints(int components) {
  if (components == 0) return {{0, 1}};
  std::vector<Point> points;
  const double norm = std::pow(2, components / 2.0 - 1) * std::tgamma(components / 2.0);
  for (const Point& v : Panels(1)) {
    const double density = std::pow(v.x, components - 1) * std::exp(-v.x * v.x / 2) / norm;
    if (v.weight * density > 1e-22) points.push_back({v.x * v.x / 2, v.weight * density});
  }
  return points;
}

struct Element {
  int i, j, k, l;
};

// -<f L g> = -<(v_a - v_b)+ f (g' - g)>, on velocities: it is the symmetric form of the matrix only
// if the exchange satisfies detailed balance.
double ByQuadrature(SiteDimensions d, const Element& e) {
  const std::vector<Point> ga = EnergyPoints(d.a - 1), gb = EnergyPoints(d.b - 1);
  const auto f = [&](int i, int j, double ea, double eb) {
    return OrthonormalLaguerre(d.a / 2.0, i, ea) * OrthonormalLaguerre(d.b / 2.0, j, eb);
  };
  double sum = 0;
  for (const Point& mean : Panels(1)) {
    for (const double sign : {-1, 1}) {
      for (const Point& half : Panels(1)) {
        const double va = sign * mean.x + half.x, vb = sign * mean.x - half.x;
        const double weight = 2 * mean.weight * half.weight * NormalDensity(va) * NormalDensity(vb);
        if (weight < 1e-20) continue;
        for (const Point& a : ga) {
          for (const Point& b : gb) {
            const double ea = a.x + va * va / 2, eb = b.x + vb * vb / 2;
            const double after_a = a.x + vb * vb / 2, after_b = b.x + va * va / 2;
            sum -= weight * a.weight * b.weight * (va - vb) * f(e.i, e.j, ea, eb) *
                   (f(e.k, e.l, after_a, after_b) - f(e.k, e.l, ea, eb));
          }
        }
      }
    }
  }
  return sum;
}

double At(const ContactMatrix& matrix, const Element& e) {
  return matrix.elements()(ContactMatrix::Row(e.i, e.j), ContactMatrix::Row(e.k, e.l));
}

// Pairs of sites with up to one further component, 14 elements each; equal sites of more
// components, four each, because their integrals have one dimension more.
TEST(ContactMatrix, AgreesWithAnIndependentQuadrature) {
  const std::vector<Element> many = {{1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 1}, {2, 0, 0, 2},
                                     {2, 1, 1, 0}, {0, 3, 2, 1}, {3, 0, 3, 0}, {1, 2, 4, 0},
                                     {2, 2, 0, 1}, {4, 1, 1, 4}, {0, 5, 5, 0}, {3, 3, 1, 0},
                                     {6, 0, 0, 1}, {2, 4, 3, 2}};
  const std::vector<Element> few = {{1, 0, 1, 0}, {2, 1, 1, 0}, {1, 2, 0, 3}, {2, 1, 3, 0}};
  for (const SiteDimensions d : kAllDimensions) {
    const ContactMatrix matrix(d, 6);
    for (const Element& e : d.b > 1 && d.a > 1 ? few : many) {
      EXPECT_NEAR(At(matrix, e), ByQuadrature(d, e), 1e-12)
          << d.a << " " << d.b << ": " << e.i << e.j << e.k << e.l;
    }
  }
}

// A function of e_a + e_b does not change: its coefficients by Gauss's quadrature.
TEST(ContactMatrix, ConservesTheEnergyOfThePair) {
  constexpr int kDegree = 8;
  for (const SiteDimensions d : kAllDimensions) {
    const ContactMatrix matrix(d, kDegree);
    const GammaQuadrature a = GammaNodes(d.a / 2.0, kDegree + 1);
    const GammaQuadrature b = GammaNodes(d.b / 2.0, kDegree + 1);
    for (int power = 0; power <= kDegree; ++power) {
      Eigen::VectorXd function = Eigen::VectorXd::Zero(ContactMatrix::Rows(kDegree));
      for (int i = 0; i <= kDegree; ++i) {
        for (int j = 0; j <= kDegree; ++j) {
          const Eigen::VectorXd p = GammaPolynomials(d.a / 2.0, kDegree, a.nodes[i]);
          const Eigen::VectorXd q = GammaPolynomials(d.b / 2.0, kDegree, b.nodes[j]);
          const double value =
              std::pow(a.nodes[i] + b.nodes[j], power) * a.weights[i] * b.weights[j];
          for (int k = 0; k <= kDegree; ++k) {
            for (int l = 0; k + l <= kDegree; ++l) {
              function[ContactMatrix::Row(k, l)] += value * p[k] * q[l];
            }
          }
        }
      }
      function.normalize();
      EXPECT_LE((matrix.elements() * function).cwiseAbs().maxCoeff(), 1e-12) << d.a << d.b << power;
    }
  }
}

TEST(ContactMatrix, IsSymmetricAndHasNoNegativeRate) {
  for (const SiteDimensions d : kAllDimensions) {
    const Eigen::MatrixXd matrix = ContactMatrix(d, 10).elements();
    EXPECT_EQ((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 0);
    const Eigen::VectorXd rates =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
    EXPECT_GE(rates[0], -1e-13 * rates[rates.size() - 1]);
    EXPECT_GT(rates[rates.size() - 1], 0.5);
  }
}

TEST(ContactMatrix, SwappedSitesSwapTheIndices) {
  const ContactMatrix matrix({2, 1}, 8), swapped({1, 2}, 8);
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; j <= 4; ++j) {
      for (int k = 0; k <= 4; ++k) {
        for (int l = 0; l <= 4; ++l) {
          EXPECT_NEAR(At(matrix, {i, j, k, l}), At(swapped, {j, i, l, k}), kContactMatrixError);
        }
      }
    }
  }
}

// Half of <rate (e_a' - e_a)^2> is the exchange rate at T = 1, whatever the dimensions.
TEST(ContactMatrix, EnergyExchangeIsTheExchangeRate) {
  EXPECT_NEAR(kContactRate, 1 / std::sqrt(std::numbers::pi), 1e-16);
  for (const SiteDimensions d : kAllDimensions) {
    EXPECT_NEAR(d.a / 2.0 * At(ContactMatrix(d, 3), {1, 0, 1, 0}), kContactRate, 1e-14);
  }
}

// High degrees leave the elements of low ones as they are.
TEST(ContactMatrix, HighDegreesAreExactToRounding) {
  for (const SiteDimensions d : {SiteDimensions{2, 1}, SiteDimensions{2, 2}}) {
    const Eigen::MatrixXd low = ContactMatrix(d, 12).elements();
    const Eigen::MatrixXd high =
        ContactMatrix(d, 20).elements().topLeftCorner(low.rows(), low.cols());
    const Eigen::ArrayXd scale = low.diagonal().cwiseMax(1e-3).cwiseSqrt();
    const Eigen::ArrayXXd difference = (high - low).cwiseAbs();
    EXPECT_LE((difference / (scale.matrix() * scale.matrix().transpose()).array()).maxCoeff(),
              kContactMatrixError);
  }
}

}  // namespace
}  // namespace ballpiston
