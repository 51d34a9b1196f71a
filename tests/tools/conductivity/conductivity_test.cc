#include "tools/conductivity/conductivity.h"

#include <Eigen/Cholesky>

#include "tests/core/preamble.h"
#include "tests/support/nightly.h"
#include "tools/conductivity/contact_matrix.h"
#include "tools/conductivity/galerkin_form.h"

namespace ballpiston {
namespace {

const Cluster kBallAndPiston = {{0, 0}, {1, 0}};
const Cluster kBallAndPistonAlongY = {{0, 0}, {0, 1}};

GalerkinForm PairsOf(const SiteLattice& lattice, int degree) {
  return {lattice,
          ClusterBasis(lattice, {kBallAndPiston, kBallAndPistonAlongY}, {.degree = degree})};
}

// Balls and pistons are half a cell apart, so kappa_0 = E/4. Of equal sites it is the exchange
// rate.
TEST(Conductivity, StaticConductivityIsHalfTheExchangeRate) {
  EXPECT_NEAR(PairsOf(BallPistonChain(), 3).field_energy() / 4, kContactRate / 2, 1e-14);
  EXPECT_NEAR(PairsOf(BallPistonLattice(), 3).field_energy() / 4, kContactRate / 2, 1e-14);
  for (const int dimension : {2, 3}) {
    const SiteLattice chain = EqualSitesChain(dimension);
    const GalerkinForm form(chain, ClusterBasis(chain, Clusters(chain, 2), {.degree = 3}));
    EXPECT_NEAR(form.field_energy(), kContactRate, 1e-14);
  }
}

// Functions of one ball and one neighbouring piston. In a square lattice the pairs along y have no
// effect. Another program computed these values before, to three digits.
TEST(Conductivity, FunctionsOfOnePairHaveTheirKnownValues) {
  const auto pairs = [](const SiteLattice& lattice) {
    const GalerkinForm form = PairsOf(lattice, 16);
    Eigen::MatrixXd matrix(form.field().size(), form.field().size());
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      matrix.col(k) = form.Apply(Eigen::VectorXd::Unit(matrix.rows(), k));
    }
    return -form.field().dot(matrix.llt().solve(form.field())) / form.field_energy();
  };
  EXPECT_NEAR(pairs(BallPistonChain()), -0.00132, 1e-5);
  EXPECT_NEAR(pairs(BallPistonLattice()), -0.00093, 1e-5);
  EXPECT_NEAR(ConductivityBound(BallPistonChain(), {2, 2}, 16), pairs(BallPistonChain()), 1e-12);
}

TEST(Conductivity, RefinementSumsTheLimitsOfItsSteps) {
  const SiteLattice chain = BallPistonChain();
  const auto bound = [&](int extent, int degree) {
    return ConductivityBound(chain, {extent, 9}, degree);
  };
  const BoundedValue first = TailLimit({4, 6, 8}, {bound(2, 4), bound(2, 6), bound(2, 8)}, 3);
  const BoundedValue second =
      TailLimit({4, 6}, {bound(3, 4) - bound(2, 4), bound(3, 6) - bound(2, 6)}, 3);
  const ConductivityRatio ratio = RefineConductivity(
      chain, {.steps = {{{0, 0}, {2, 9}, {4, 6, 8}}, {{2, 9}, {3, 9}, {4, 6}}}, .beyond = 0.5});
  EXPECT_NEAR(ratio.correction, first.value + 1.5 * second.value, 1e-15);
  EXPECT_NEAR(ratio.error, first.error + second.error - 0.25 * second.value, 1e-15);
  EXPECT_EQ(ratio.upper_bound, bound(3, 6));
  EXPECT_EQ(ratio.table.size(), 5);
}

struct Constant {
  SiteLattice lattice;
  BoundedValue value;
  double quick_error;  // of the quick plan, at most
};

const std::vector<Constant> kConstants = {{BallPistonChain(), kChainCorrection, 3e-6},
                                          {BallPistonLattice(), kLatticeCorrection, 3e-6},
                                          {EqualSitesChain(2), kDiscChainCorrection, 3e-6},
                                          {EqualSitesChain(3), kSphereChainCorrection, 1e-7}};

// A unit of the published last digit. QuickPlanAgreesWithTheConstants computes the constant.
TEST(Conductivity, SpheresHaveThePublishedValue) {
  EXPECT_NEAR(kSphereChainCorrection.value, -0.000373, 1e-6);
}

TEST(Conductivity, QuickPlanAgreesWithTheConstants) {
  for (const auto& [lattice, constant, quick_error] : kConstants) {
    const ConductivityRatio quick = RefineConductivity(lattice, QuickPlan(lattice));
    EXPECT_NEAR(quick.correction, constant.value, quick.error);
    EXPECT_LE(quick.error, quick_error);
    EXPECT_GT(quick.upper_bound, constant.value);
    EXPECT_GE(quick.table.size(), 8);
    for (const ComputedBound& row : quick.table) EXPECT_GE(row.correction, quick.upper_bound);
  }
}

TEST(Conductivity, FinePlanGivesTheConstants) {
  if (!IsNightly()) GTEST_SKIP() << "takes half a minute";
  for (const auto& [lattice, constant, quick_error] : kConstants) {
    const ConductivityRatio fine = RefineConductivity(lattice, FinePlan(lattice));
    EXPECT_LE(fine.error, constant.error);
    EXPECT_NEAR(fine.correction, constant.value, constant.error / 4);
  }
}

}  // namespace
}  // namespace ballpiston
