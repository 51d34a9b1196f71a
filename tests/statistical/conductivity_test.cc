// The constants of the conductivity, and the gaps of chains, with slow refinements. The nightly
// sizes are those of docs/conductivity.md.
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

// FinePlan without its largest clusters and without the two highest degrees of each cluster (at
// least two degrees stay). It takes a sixth of the time or less.
RefinementPlan PartOfFinePlan(const SiteLattice& lattice) {
  RefinementPlan plan = FinePlan(lattice);
  plan.steps.resize(plan.steps.size() - (lattice.has_rows ? 2 : 1));
  for (RefinementStep& step : plan.steps) {
    step.degrees.resize(std::max<size_t>(step.degrees.size() - 2, 2));
  }
  return plan;
}

// The nightly test recomputes the constant. With the part of the plan the stated error is some five
// times as large, and the constant is within it.
void GivesTheConstant(const char* name, const SiteLattice& lattice, ExtrapolatedValue constant) {
  const ConductivityRatio ratio =
      RefineConductivity(lattice, IsNightly() ? FinePlan(lattice) : PartOfFinePlan(lattice));
  std::cout << name << std::setprecision(9) << ": " << ratio.correction << " +- " << ratio.error
            << ", bound " << ratio.upper_bound << "\n";
  for (const ComputedBound& row : ratio.table) {
    std::cout << "  extent " << row.size.extent << ", sites " << row.size.sites << ", degree "
              << row.degree << ": " << row.correction << "\n";
  }
  EXPECT_LE(ratio.error, (IsNightly() ? 1 : 6) * constant.error);
  EXPECT_NEAR(ratio.correction, constant.value, IsNightly() ? constant.error / 4 : ratio.error);
}

TEST(Conductivity, RefinementGivesTheChain) {
  GivesTheConstant("chain", BallPistonChain(), kChainCorrection);
}

TEST(Conductivity, RefinementGivesTheLattice) {
  GivesTheConstant("lattice", BallPistonLattice(), kLatticeCorrection);
}

TEST(Conductivity, RefinementGivesDiscs) {
  GivesTheConstant("discs", EqualSitesChain(2), kDiscChainCorrection);
}

TEST(Conductivity, RefinementGivesSpheres) {
  GivesTheConstant("spheres", EqualSitesChain(3), kSphereChainCorrection);
}

TEST(ChainGap, GapOfThePairIsExactToTwelveDigits) {
  const std::vector<int> degrees =
      IsNightly() ? std::vector{20, 24, 30, 36} : std::vector{18, 22, 26, 30};
  EXPECT_NEAR(ChainGap({2, 1}, degrees).value, 0.152087126613526, 1e-12);
}

struct ClosedChain {
  std::vector<int> dimensions;
  std::vector<int> degrees;
  ExtrapolatedValue documented;
};

// The values of docs/conductivity.md, by fewer degrees. The stated error is the change by the last
// term, which can be half of the true error. Chains that take more than half a second run only in
// the nightly test, except one of five sites.
TEST(ChainGap, ChainsHaveTheirDocumentedGaps) {
  std::vector<ClosedChain> chains = {
      {{2, 1, 2}, {12, 14, 16, 18}, {0.113388479, 2e-9}},
      {{1, 2, 1}, {12, 14, 16, 18}, {0.146330848, 1e-9}},
      {{2, 1, 2, 1}, {8, 10, 12}, {0.10916656, 3e-8}},
      {{2, 1, 2, 1, 2}, {6, 8, 10}, {0.0824165, 1e-7}},
  };
  if (IsNightly()) {
    for (size_t i : {0, 1}) chains[i].degrees.push_back(20);
    chains[2].degrees.push_back(14);
    chains.push_back({{1, 2, 1, 2, 1}, {6, 8, 10}, {0.1018311, 2e-7}});
    chains.push_back({{2, 1, 2, 1, 2, 1}, {4, 6, 8}, {0.067823, 1e-6}});
  }
  for (const ClosedChain& chain : chains) {
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
