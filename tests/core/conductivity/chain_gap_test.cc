#include "core/conductivity/chain_gap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/markov/relaxation_spectrum.h"

namespace ballpiston {
namespace {

// Two methods for the same operator: the generator uses piecewise polynomials of the piston's
// speed. tests/statistical compares them to 1e-12, with higher degrees.
TEST(ChainGap, GapOfThePairMatchesItsGenerator) {
  const double exact = RelaxationSpectrum::Get().Gap().value;
  for (const std::vector<int>& pair : {std::vector<int>{2, 1}, {1, 2}}) {
    EXPECT_NEAR(ChainGap(pair, {10, 12, 14, 16}).value, exact, 5e-11);
    EXPECT_NEAR(ChainRates(pair, 16)[1], 0.1771867982882, 1e-7);
    EXPECT_GT(ChainRates(pair, 16)[0], exact);
  }
}

// With one ball and one piston, the first polynomial's rate is a ratio of moments: 15/32.
TEST(ChainGap, LinearFunctionOfThePairHasARationalRate) {
  EXPECT_NEAR(ChainRates({2, 1}, 1)[0], 15.0 / 32, 1e-14);
}

TEST(ChainGap, GapFallsWithDegree) {
  for (const std::vector<int>& chain : {std::vector<int>{2, 1, 2}, {1, 2, 1}, {2, 1, 2, 1}}) {
    double last = 1;
    for (const int degree : {1, 2, 4, 6}) {
      const double gap = ChainRates(chain, degree)[0];
      EXPECT_LT(gap, last - 1e-6);
      EXPECT_GT(gap, 0.1);
      last = gap;
    }
  }
}

TEST(ChainGap, SpectrumDoesNotDependOnTheDirectionOfTheChain) {
  const Eigen::VectorXd one = ChainRates({2, 1, 2, 1}, 5), other = ChainRates({1, 2, 1, 2}, 5);
  ASSERT_EQ(one.size(), 55);  // 8!/(5! 3!) polynomials, without the constant
  EXPECT_LE((one - other).cwiseAbs().maxCoeff(), 1e-12);
}

// docs/conductivity.md has the table.
TEST(ChainGap, LongerChainsRelaxMoreSlowly) {
  EXPECT_NEAR(ChainGap({2, 1, 2}, {6, 8, 10, 12}).value, 0.113388480, 2e-7);
  EXPECT_NEAR(ChainGap({1, 2, 1}, {6, 8, 10, 12}).value, 0.146330848, 2e-7);
  EXPECT_NEAR(ChainGap({2, 1, 2, 1}, {4, 6, 8}).value, 0.10916655, 2e-6);
}

}  // namespace
}  // namespace ballpiston
