#include "core/conductivity/test_function.h"

#include <cmath>

namespace ballpiston {
namespace {

// The orthonormal polynomials p_k of gamma_law.h by their recurrence, with its numbers known.
class Polynomials {
 public:
  explicit Polynomials(double shape) {
    for (size_t k = 0; k <= TestFunction::kDegree; ++k) {
      const auto n = static_cast<double>(k);
      a_[k] = 2 * n + shape;
      root_b_[k] = std::sqrt(n * (n + shape - 1));
    }
  }

  TestFunction::Values Sum(const TestFunction::Coefficients& coefficients, double x) const {
    TestFunction::Values sum = {};
    double before = 0, p = 1;
    for (size_t k = 0; k < TestFunction::kDegree; ++k) {
      const double next = ((x - a_[k]) * p - root_b_[k] * before) / root_b_[k + 1];
      before = p;
      p = next;
      for (size_t r = 0; r < sum.size(); ++r) sum[r] += coefficients[r][k] * p;
    }
    return sum;
  }

 private:
  std::array<double, TestFunction::kDegree + 1> a_;
  std::array<double, TestFunction::kDegree + 1> root_b_;
};

}  // namespace

TestFunction::Values TestFunction::OfBall(double energy) const {
  static const Polynomials polynomials(1);
  return polynomials.Sum(of_ball, energy);
}

TestFunction::Values TestFunction::OfPiston(double energy) const {
  static const Polynomials polynomials(0.5);
  return polynomials.Sum(of_piston, energy);
}

}  // namespace ballpiston
