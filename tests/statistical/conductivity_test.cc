// The constants of the conductivity, and gaps of closed chains, at refinements that take long.
#include "core/conductivity/conductivity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <iostream>

#include "core/conductivity/chain_gap.h"

namespace ballpiston {
namespace {

void IsTheFineValue(const char* name, const SiteLattice& lattice, ExtrapolatedValue constant) {
  const ConductivityRatio fine = RefineConductivity(lattice, FinePlan(lattice));
  std::cout << name << std::setprecision(9) << ": " << fine.correction << " +- " << fine.error
            << ", bound " << fine.upper_bound << "\n";
  for (const ComputedBound& row : fine.table) {
    std::cout << "  extent " << row.size.extent << ", sites " << row.size.sites << ", degree "
              << row.degree << ": " << row.correction << "\n";
  }
  EXPECT_LE(fine.error, constant.error);
  EXPECT_NEAR(fine.correction, constant.value, constant.error / 4);
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
  EXPECT_NEAR(ChainGap({2, 1}, {20, 24, 30, 36}).value, 0.152087126613526, 1e-12);
}

}  // namespace
}  // namespace ballpiston
