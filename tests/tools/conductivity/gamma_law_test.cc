#include "tools/conductivity/gamma_law.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// <x^k> is Gamma(shape + k)/Gamma(shape), a product of k factors.
TEST(GammaLaw, QuadratureIsExactBelowTwiceItsNodes) {
  for (const double shape : {0.5, 1.0, 1.5, 2.0, 5.0}) {
    for (const int count : {1, 2, 7, 20, 40}) {
      const GammaQuadrature rule = GammaNodes(shape, count);
      double exact = 1;
      for (int k = 0; k <= 2 * count - 1; ++k) {
        const double mean = rule.weights.dot(rule.nodes.array().pow(k).matrix());
        EXPECT_NEAR(mean / exact, 1, kGammaQuadratureError) << shape << " " << count << " " << k;
        exact *= shape + k;
      }
    }
  }
}

TEST(GammaLaw, PolynomialsAreOrthonormal) {
  constexpr int kDegree = 20;
  for (const double shape : {0.5, 1.0, 1.5}) {
    const GammaQuadrature rule = GammaNodes(shape, kDegree + 1);
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kDegree + 1, kDegree + 1);
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const Eigen::VectorXd p = GammaPolynomials(shape, kDegree, rule.nodes[i]);
      products += rule.weights[i] * p * p.transpose();
    }
    EXPECT_LE(
        (products - Eigen::MatrixXd::Identity(kDegree + 1, kDegree + 1)).cwiseAbs().maxCoeff(),
        kGammaQuadratureError)
        << shape;
    EXPECT_GT(GammaPolynomials(shape, kDegree, 200.0).minCoeff(), 0);
  }
}

}  // namespace
}  // namespace ballpiston
