#include "core/conductivity/test_function.h"

#include "tests/core/preamble.h"
#include "tools/conductivity/conductivity.h"
#include "tools/conductivity/contact_matrix.h"
#include "tools/conductivity/gamma_law.h"

namespace ballpiston {
namespace {

using TermValues = TestFunction::Values;
using Squares = Eigen::Matrix<double, TestFunction::kTerms, TestFunction::kTerms>;

// Means and covariances of the functions of a body, whose energy has a Gamma law.
struct Law {
  template <typename F>
  Law(double shape, F values) {
    const GammaQuadrature rule = GammaNodes(shape, 60);
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const TermValues at = values(rule.nodes[i]);
      mean += rule.weights[i] * at;
      covariance += rule.weights[i] * at.matrix() * at.matrix().transpose();
    }
    covariance -= mean.matrix() * mean.matrix().transpose();
  }

  TermValues mean = TermValues::Zero();
  Squares covariance = Squares::Zero();
};

double Contracted(const Squares& matrix, const TermValues& v) {
  return v.matrix().dot(matrix * v.matrix());
}

// Varadhan's formula for f. An exchange changes X + f by the pair's own part, and by products with
// the bodies beside the pair, which are independent of it: their covariances are enough. A lattice
// has as many contacts along y, where the ball's two neighbours along x count. The quadrature is
// that of contact_matrix.cc.
double BoundOf(const TestFunction& f, bool is_lattice) {
  constexpr int kNodes = 40;
  const Law ball(1, [&](double e) { return f.OfBall(e); });
  const Law piston(0.5, [&](double e) { return f.OfPiston(e); });
  const GammaQuadrature t = GammaNodes(2, kNodes), y = GammaNodes(1.5, kNodes),
                        g = GammaNodes(0.5, kNodes);
  double with_f = 0, alone = 0;
  for (int i = 0; i < kNodes; ++i) {
    for (int j = 0; j < kNodes; ++j) {
      for (int k = 0; k < kNodes; ++k) {
        const double r = std::sqrt(t.nodes[i] * y.nodes[j]);
        const double middle = (t.nodes[i] + y.nodes[j]) / 2;
        const double weight = t.weights[i] * y.weights[j] * g.weights[k] / (r * r);
        const TermValues u = f.OfBall(middle + r + g.nodes[k]), w = f.OfPiston(middle - r);
        const TermValues u1 = f.OfBall(middle - r + g.nodes[k]), w1 = f.OfPiston(middle + r);
        const double own = 2 * r + ((u1 - ball.mean) * (w1 - piston.mean)).sum() -
                           ((u - ball.mean) * (w - piston.mean)).sum();
        const TermValues of_ball = u1 - u, of_piston = w1 - w;
        with_f += weight * (own * own + Contracted(ball.covariance, of_piston) +
                            (is_lattice ? 3 : 1) * Contracted(piston.covariance, of_ball));
        alone += weight * 4 * r * r;
      }
    }
  }
  return with_f / alone - 1;
}

TEST(TestFunction, HasItsBound) {
  for (const auto& [f, is_lattice, correction] :
       {std::tuple(kChainTestFunction, false, kChainCorrection),
        {kLatticeTestFunction, true, kLatticeCorrection}}) {
    EXPECT_NEAR(BoundOf(f, is_lattice), f.bound, 1e-10) << is_lattice;
    EXPECT_GT(f.bound, correction.value) << is_lattice;
  }
}

}  // namespace
}  // namespace ballpiston
