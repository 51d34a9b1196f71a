#include "core/conductivity/test_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "core/conductivity/cluster_basis.h"
#include "core/conductivity/conductivity.h"
#include "core/conductivity/contact_matrix.h"
#include "core/conductivity/galerkin_form.h"
#include "core/conductivity/site_lattice.h"

namespace ballpiston {
namespace {

struct Case {
  const char* name;
  SiteLattice lattice;
  TestFunction f;
  ExtrapolatedValue correction;

  friend void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }
};

// The value of Varadhan's formula, and that of the multiple of f for which it is least.
struct Bounds {
  double of_f;
  double least;
};

Bounds BoundsOf(const SiteLattice& lattice, const TestFunction& f) {
  constexpr int kDegree = TestFunction::kDegree;
  const ClusterBasis basis(lattice, ChainClusters(lattice, 2), {2 * kDegree, 2});
  const GalerkinForm form(lattice, basis, ContactMatrix(lattice.dimensions, 2 * kDegree));
  Eigen::VectorXd v = Eigen::VectorXd::Zero(basis.size());
  for (int16_t m = 1; m <= kDegree; ++m) {
    for (int16_t n = 1; n <= kDegree; ++n) {
      const int place = basis.Find({{Site{0, 0}, m}, {Site{1, 0}, n}});
      for (size_t r = 0; r < TestFunction::kTerms; ++r) {
        v[std::abs(place) - 1] += (place > 0 ? 1 : -1) * f.of_ball[r][static_cast<size_t>(m - 1)] *
                                  f.of_piston[r][static_cast<size_t>(n - 1)];
      }
    }
  }
  const double linear = form.field().dot(v), square = v.dot(form.Apply(v));
  return {(2 * linear + square) / form.field_energy(),
          -linear * linear / square / form.field_energy()};
}

class TestFunctionTest : public testing::TestWithParam<Case> {};

TEST_P(TestFunctionTest, HasItsBound) {
  const Bounds bounds = BoundsOf(GetParam().lattice, GetParam().f);
  EXPECT_NEAR(bounds.of_f, GetParam().f.bound, 1e-15);
  EXPECT_GT(bounds.of_f, GetParam().correction.value);
  EXPECT_LT(bounds.of_f, bounds.least * 0.9999) << "no multiple is much better";
}

INSTANTIATE_TEST_SUITE_P(
    All, TestFunctionTest,
    testing::Values(Case{"chain", BallPistonChain(), kChainTestFunction, kChainCorrection},
                    Case{"lattice", BallPistonLattice(), kLatticeTestFunction, kLatticeCorrection}),
    [](const testing::TestParamInfo<Case>& tested) { return tested.param.name; });

}  // namespace
}  // namespace ballpiston
