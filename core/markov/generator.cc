#include "core/markov/generator.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/arithmetic/gauss_nodes.h"
#include "core/closed_form/kernel.h"

namespace ballpiston {
namespace {

using std::numbers::pi;

constexpr double kGrading = 0.15;  // ratio of neighbouring element lengths, toward an end
constexpr int kNodes = 30;

// Graded towards both ends of [0, pi/4], and mirrored.
std::vector<double> MeshEdges(int levels) {
  std::vector<double> half = {0};
  for (int k = levels; k >= 0; --k) half.push_back(pi / 8 * std::pow(kGrading, k));
  for (int k = 1; k <= levels; ++k) half.push_back(pi / 4 - pi / 8 * std::pow(kGrading, k));
  half.push_back(pi / 4);
  std::vector<double> edges = half;
  for (size_t i = half.size() - 1; i-- > 0;) edges.push_back(pi / 2 - half[i]);
  return edges;
}

// Legendre polynomials of degree 0 ... degree at x in [-1, 1].
Eigen::VectorXd Legendre(int degree, double x) {
  Eigen::VectorXd p(degree + 1);
  p[0] = 1;
  if (degree > 0) p[1] = x;
  for (int n = 1; n < degree; ++n) p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1);
  return p;
}

}  // namespace

double JumpRate(double u) { return PairCollisionRate(u * u / 2); }

Generator::Generator(const Discretisation& discretisation) : Generator(discretisation, true) {}

Generator Generator::OfLosses(const Discretisation& discretisation) {
  return Generator(discretisation, false);
}

Generator::Generator(const Discretisation& discretisation, bool has_gains)
    : degree_(discretisation.degree), edges_(MeshEdges(discretisation.levels)) {
  OrthonormaliseBases();
  const Eigen::MatrixXd computed = MinusL(has_gains);
  const Eigen::MatrixXd symmetric = (computed + computed.transpose()) / 2;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  rates_ = solver.eigenvalues();
  functions_ = solver.eigenvectors();
  asymmetry_ = (computed - computed.transpose()).cwiseAbs().maxCoeff();
}

// Both differences are exact, also in the shortest elements at the far end.
double Generator::Within(size_t e, double theta) const {
  return 2 * (theta - edges_[e]) / (edges_[e + 1] - edges_[e]) - 1;
}

void Generator::OrthonormaliseBases() {
  for (size_t e = 0; e + 1 < edges_.size(); ++e) {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(degree_ + 1, degree_ + 1);
    ForEachGaussNodeWithRoot<kNodes>(edges_[e], edges_[e + 1], [&](double theta, double weight) {
      const Eigen::VectorXd p = Legendre(degree_, Within(e, theta));
      mass += weight * std::cos(theta) * p * p.transpose();
    });
    const Eigen::MatrixXd lower = mass.llt().matrixL();
    orthonormal_.push_back(lower.triangularView<Eigen::Lower>().solve(
        Eigen::MatrixXd::Identity(degree_ + 1, degree_ + 1)));
  }
}

Eigen::VectorXd Generator::Basis(size_t e, double theta) const {
  return orthonormal_[e] * Legendre(degree_, Within(e, theta));
}

// With u' = s sin(phi), du'/sqrt(s^2 - u'^2) = dphi.
Eigen::VectorXd Generator::KernelRow(double theta, size_t elements) const {
  const double u = std::sin(theta), s = std::cos(theta);
  const auto angle = [s](double v) { return v < s ? std::asin(v / s) : pi / 2; };
  Eigen::VectorXd row = Eigen::VectorXd::Zero(First(elements));
  for (size_t e = 0; e < elements; ++e) {
    const double a = std::sin(edges_[e]), b = std::sin(edges_[e + 1]);
    if (a >= s) break;
    const auto add = [&](double phi, double weight) {
      const double v = s * std::sin(phi);
      row.segment(First(e), degree_ + 1) +=
          weight * kJumpKernelPrefactor * std::max(u, v) * Basis(e, std::asin(v));
    };
    const double kink = std::clamp(u, a, b);
    ForEachGaussNode<kNodes>(angle(a), angle(kink), add);
    ForEachGaussNode<kNodes>(angle(kink), angle(b), add);
  }
  return row;
}

Eigen::MatrixXd Generator::MinusL(bool has_gains) const {
  // Only the gains from u' below 1/sqrt(2) are computed; the rest follows by symmetry.
  const size_t slow_elements = (edges_.size() - 1) / 2;
  const Eigen::Index n = First(edges_.size() - 1), slow = First(slow_elements);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (size_t e = 0; e + 1 < edges_.size(); ++e) {
    const Eigen::Index first = First(e), count = degree_ + 1;
    ForEachGaussNodeWithRoot<kNodes>(edges_[e], edges_[e + 1], [&](double theta, double weight) {
      const Eigen::VectorXd basis = weight * std::cos(theta) * Basis(e, theta);
      if (has_gains) {
        matrix.block(first, 0, count, slow) -= basis * KernelRow(theta, slow_elements).transpose();
      }
      matrix.block(first, first, count, count) +=
          JumpRate(std::sin(theta)) * basis * Basis(e, theta).transpose();
    });
  }
  matrix.topRightCorner(slow, slow) = matrix.bottomLeftCorner(slow, slow).transpose();
  return matrix;
}

Eigen::VectorXd Generator::Coefficients(const std::function<double(double)>& function) const {
  Eigen::VectorXd projected = Eigen::VectorXd::Zero(functions_.rows());
  for (size_t e = 0; e + 1 < edges_.size(); ++e) {
    ForEachGaussNodeWithRoot<kNodes>(edges_[e], edges_[e + 1], [&](double theta, double weight) {
      projected.segment(First(e), degree_ + 1) +=
          weight * std::cos(theta) * function(std::sin(theta)) * Basis(e, theta);
    });
  }
  return functions_.transpose() * projected;
}

Eigen::VectorXd Generator::Gains(double u) const {
  return functions_.transpose() * KernelRow(std::asin(u), edges_.size() - 1);
}

Eigen::VectorXd Generator::At(double u) const {
  const double theta = std::asin(u);
  const auto above = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, theta);
  const auto element = static_cast<size_t>(above - edges_.begin()) - 1;
  return functions_.middleRows(First(element), degree_ + 1).transpose() * Basis(element, theta);
}

}  // namespace ballpiston
