// The generator of the pair's jump process on n equal cells of u = sqrt(2 ep): a slow, independent
// discretisation, with piecewise constant functions, exact integrals and no quadrature.
//
// The rate density u -> u' is K = max(u, u')/(sqrt(2) pi sqrt(1 - u^2 - u'^2)) on the unit disc's
// quarter. Where u' > u it integrates over u' to a root, and that over u to a circle's area:
//
//   int_0^a du int_0^b du' K = (2 sqrt(2) A(m, 1/sqrt(2)) - A(m, sqrt(1 - a^2))
//                               - A(m, sqrt(1 - b^2)))/(sqrt(2) pi),   m = min(a, b),
//   A(m, c) = int_0^min(m, c) sqrt(c^2 - x^2) dx
//
// Rows sum to the rate at which a cell is left, without use of its closed form. Errors fall as
// 1/n^2, and after one extrapolation as 1/n^3.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace ballpiston::oracle {

class EnergyCells {
 public:
  explicit EnergyCells(Eigen::Index n) : minus_l_(n, n), energy_(n) {
    Eigen::MatrixXd up_to(n + 1, n + 1);
    for (Eigen::Index i = 0; i <= n; ++i) {
      for (Eigen::Index k = 0; k <= n; ++k) up_to(i, k) = RateInto(Edge(i), Edge(k));
    }
    const double width = Edge(1);
    minus_l_ = -(up_to.bottomRightCorner(n, n) - up_to.topRightCorner(n, n) -
                 up_to.bottomLeftCorner(n, n) + up_to.topLeftCorner(n, n)) /
               width;
    // The rate at which each cell is left, its own included: the mean of the jump rate over it.
    minus_l_.diagonal() -= minus_l_.rowwise().sum();
    for (Eigen::Index i = 0; i < n; ++i) {
      energy_[i] = (std::pow(Edge(i + 1), 3) - std::pow(Edge(i), 3)) / (6 * width) - 1.0 / 6;
    }
  }

  // Eigenvalues of -L, ascending.
  Eigen::VectorXd Rates() const {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(minus_l_, Eigen::EigenvaluesOnly)
        .eigenvalues();
  }

  // int_0^inf <ep(0) ep(t)> - <ep>^2 dt over its value at t = 0, which is 1/45.
  double CorrelationTime() const {
    const double n = static_cast<double>(energy_.size());
    // Makes the matrix invertible on the stationary law, the kernel of L.
    const Eigen::MatrixXd invertible = minus_l_.array() + 1 / n;
    return 45 * energy_.dot(invertible.partialPivLu().solve(energy_)) / n;
  }

 private:
  double Edge(Eigen::Index i) const {
    return static_cast<double>(i) / static_cast<double>(energy_.size());
  }

  static double CircleArea(double m, double c) {
    if (m >= c) return std::numbers::pi * c * c / 4;
    return (m * std::sqrt((c - m) * (c + m)) + c * c * std::asin(m / c)) / 2;
  }

  static double RateInto(double a, double b) {
    const double m = std::min(a, b);
    const double fast =
        CircleArea(m, std::sqrt((1 - a) * (1 + a))) + CircleArea(m, std::sqrt((1 - b) * (1 + b)));
    return (2 * std::numbers::sqrt2 * CircleArea(m, std::sqrt(0.5)) - fast) /
           (std::numbers::sqrt2 * std::numbers::pi);
  }

  Eigen::MatrixXd minus_l_;
  Eigen::VectorXd energy_;  // mean of ep - 1/6 over each cell
};

// The limit of `value` for many cells, from n, 2 n and 4 n cells, with errors 1/n^2 and 1/n^3.
template <typename Function>
auto FromEnergyCells(Eigen::Index n, Function value) {
  using Value = decltype(value(EnergyCells(n)));
  const Value coarse = value(EnergyCells(n)), middle = value(EnergyCells(2 * n)),
              fine = value(EnergyCells(4 * n));
  const Value first = middle + (middle - coarse) / 3, second = fine + (fine - middle) / 3;
  return Value(second + (second - first) / 7);
}

}  // namespace ballpiston::oracle
