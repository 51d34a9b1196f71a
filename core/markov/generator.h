// The discretised generator of the pair's jump process, which describes the relaxation of the
// energies.
//
//   (L g)(u) = int_0^s K(u, u') (g(u') - g(u)) du',  K = max(u, u')/(sqrt(2) pi sqrt(1 - u^2 -
//   u'^2))
//
// with u = sqrt(2 ep) and s = sqrt(1 - u^2). This is eq. meq in the variable u, in which the kernel
// (eq. kernel) is symmetric and the stationary law is uniform on [0, 1]. -L is self-adjoint and
// non-negative; the eigenvalue 0 belongs to the stationary law. The continuous spectrum is the
// range of the jump rate, [1/(sqrt(2) pi), 1/(2 sqrt(2))], because K is weakly singular and thus
// compact.
//
// Method: Galerkin, with polynomials in theta = arcsin u on a mesh that is symmetric under
// theta -> pi/2 - theta. Then the kernel's singularity u^2 + u'^2 = 1 lies only on corners and
// diagonals of the mesh's squares. Substitutions remove it there, so matrix elements are exact to
// rounding. Eigenfunctions are not smooth at u = 0 and 1 (u^2 log u) and, on one side, at 1/sqrt(2)
// (power 3/2); there the mesh is graded. Eigenvalues below the continuum converge from above, with
// the square of the error of their functions.
//
// Units: rates |dG_bp|/|G|, times |G|/|dG_bp|. Properties, each with the test that bears its name:
//   1. ConservesProbability: L 1 = 0, and L is symmetric, to kGeneratorRoundingError.
//   2. EvolutionObeysTheMasterEquation. Rates converge from above as degree and levels grow.
//
// Immutable; safe to share between threads.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <numbers>
#include <vector>

namespace ballpiston {

// A program frees memory that the library allocates. Eigen does both according to the alignment,
// which depends on the instruction set.
static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 16, "compile without -mavx and -march=native");

inline constexpr double kGeneratorRoundingError = 1e-13;

// The lower end of the continuum of -L: the least jump rate, at u = 0.
inline constexpr double kContinuumBottom = std::numbers::inv_pi / std::numbers::sqrt2;

inline constexpr double kJumpKernelPrefactor = std::numbers::inv_pi / std::numbers::sqrt2;  // of K

// int_0^s K(u, u') du'
double JumpRate(double u);

struct Discretisation {
  int degree = 10;  // of the polynomials, 1 to 20
  int levels = 5;   // of the mesh's grading, 1 to 8; 4 (levels + 1) elements

  friend bool operator==(const Discretisation&, const Discretisation&) = default;
};

class Generator {
 public:
  explicit Generator(const Discretisation& discretisation);
  // Only the losses: the multiplication by the jump rate. Probability is not conserved.
  static Generator OfLosses(const Discretisation& discretisation);

  Eigen::Index size() const { return rates_.size(); }

  // Eigenvalues of -L, ascending; the first is 0 up to rounding.
  const Eigen::VectorXd& rates() const { return rates_; }

  // Coefficients of a function of u in the eigenfunctions, which are orthonormal in du on [0, 1].
  // `function` may have kinks only at 0, 1/sqrt(2) and 1.
  Eigen::VectorXd Coefficients(const std::function<double(double)>& function) const;

  // Coefficients of a unit mass at u in [0, 1]: <coefficients, At(u)> is the function's value at u.
  Eigen::VectorXd At(double u) const;

  // int K(u, u') function_k(u') du' for each eigenfunction k.
  Eigen::VectorXd Gains(double u) const;

  // The largest difference of the computed matrix from its transpose.
  double asymmetry() const { return asymmetry_; }

 private:
  Generator(const Discretisation& discretisation, bool has_gains);

  Eigen::Index First(size_t element) const {
    return static_cast<Eigen::Index>(element) * (degree_ + 1);
  }
  // Where theta lies in the element, from -1 to 1.
  double Within(size_t element, double theta) const;
  // The element's basis at theta.
  Eigen::VectorXd Basis(size_t element, double theta) const;
  void OrthonormaliseBases();
  // int K(u, u') basis(u') du' of the bases of the first elements.
  Eigen::VectorXd KernelRow(double theta, size_t elements) const;
  Eigen::MatrixXd MinusL(bool has_gains) const;

  int degree_;
  std::vector<double> edges_;                 // of the elements, in theta
  std::vector<Eigen::MatrixXd> orthonormal_;  // by element: from Legendre's to the basis
  Eigen::VectorXd rates_;
  Eigen::MatrixXd functions_;  // eigenfunctions by column, in the bases
  double asymmetry_ = 0;
};

}  // namespace ballpiston
