// The constants of the conductivity, and the gaps of chains, with slow refinements.
#include "core/conductivity/conductivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <vector>

#include "core/conductivity/chain_gap.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// The fine plan takes 20 s. Without its last step, and with two degrees fewer, it takes at most 5
// s; its errors are five times those of the fine plan, and the constants lie within them.
RefinementPlan PlanOfTest(const SiteLattice& lattice) {
  RefinementPlan plan = FinePlan(lattice);
  if (IsNightly()) return plan;
  plan.steps.pop_back();
  for (RefinementStep& step : plan.steps) {
    step.degrees.resize(std::max<size_t>(2, step.degrees.size() - 2));
  }
  return plan;
}

void IsTheFineValue(const char* name, const SiteLattice& lattice, ExtrapolatedValue constant) {
  const ConductivityRatio fine = RefineConductivity(lattice, PlanOfTest(lattice));
  std::cout << name << std::setprecision(9) << ": " << fine.correction << " +- " << fine.error
            << ", bound " << fine.upper_bound << "\n";
  for (const ComputedBound& row : fine.table) {
    std::cout << "  extent " << row.size.extent << ", sites " << row.size.sites << ", degree "
              << row.degree << ": " << row.correction << "\n";
  }
  EXPECT_LE(fine.error, constant.error * (IsNightly() ? 1 : 5));
  EXPECT_NEAR(fine.correction, constant.value, IsNightly() ? constant.error / 4 : fine.error);
}

TEST(Conductivity, FinePlanGivesTheChain) {
  IsTheFineValue("chain", BallPistonChain(), kChainCorrection);
}

TEST(Conductivity, FinePlanGivesTheLattice) {
  IsTheFineValue("lattice", BallPistonLattice(), kLatticeCorrection);
}

TEST(Conductivity, FinePlanGivesDiscs) {
  IsTheFineValue("discs", EqualSitesChain(2), kDiscChainCorrection);
}

TEST(Conductivity, FinePlanGivesSpheres) {
  IsTheFineValue("spheres", EqualSitesChain(3), kSphereChainCorrection);
}

TEST(ChainGap, GapOfThePairIsExactToTwelveDigits) {
  EXPECT_NEAR(ChainGap({2, 1}, {16, 20, 24, 28}).value, 0.152087126613526, 1e-12);
}

struct ClosedChain {
  std::vector<int> dimensions;
  std::vector<int> degrees;
  ExtrapolatedValue documented;
};

// The values of docs/conductivity.md, by fewer degrees. The stated error is
// the change by the last term, which can be half of the true error. Chains of more than four sites
// wait for the night.
TEST(ChainGap, ChainsHaveTheirDocumentedGaps) {
  const ClosedChain chains[] = {
      {{2, 1, 2}, {12, 14, 16, 18, 20}, {0.113388479, 2e-9}},
      {{1, 2, 1}, {12, 14, 16, 18, 20}, {0.146330848, 1e-9}},
      {{2, 1, 2, 1}, {8, 10, 12, 14}, {0.10916656, 3e-8}},
      {{2, 1, 2, 1, 2}, {6, 8, 10}, {0.0824165, 1e-7}},
      {{1, 2, 1, 2, 1}, {6, 8, 10}, {0.1018311, 2e-7}},
      {{2, 1, 2, 1, 2, 1}, {4, 6, 8}, {0.067823, 1e-6}},
  };
  for (const ClosedChain& chain : chains) {
    if (chain.dimensions.size() > 4 && !IsNightly()) continue;
    for (const int site : chain.dimensions) std::cout << site;
    for (const int degree : chain.degrees) {
      std::cout << "  degree " << degree << ": " << std::setprecision(9)
                << ChainRates(chain.dimensions, degree)[0];
    }
    const ExtrapolatedValue gap = ChainGap(chain.dimensions, chain.degrees);
    std::cout << "  extrapolated " << gap.value << " +- " << gap.error << "\n";
    EXPECT_NEAR(gap.value, chain.documented.value, 2 * gap.error + chain.documented.error);
    EXPECT_LT(gap.error, 2e-6 * gap.value);
  }
}

}  // namespace
}  // namespace ballpiston
