#include "core/closed_form/canonical_measure.h"

#include "core/closed_form/kernel_moments.h"
#include "tests/core/preamble.h"
#include "tests/oracle/canonical_average.h"

namespace ballpiston {
namespace {

using oracle::CanonicalAverage;
using oracle::kCanonicalAverageError;

TEST(CanonicalMeasure, AveragesEqualIntegralsOfTheMoments) {
  for (double beta : {0.1, 1.0, 7.0}) {
    const CanonicalAverages averages = AveragesAt(beta);
    const auto current = [](double eb, double ep) { return (eb - ep) * EnergyCurrent(eb, ep); };
    EXPECT_NEAR(CanonicalAverage(beta, CollisionRate) / averages.mean_f, 1, kCanonicalAverageError);
    EXPECT_NEAR(CanonicalAverage(beta, current) / averages.mean_energy_current, 1,
                kCanonicalAverageError);
    EXPECT_NEAR(CanonicalAverage(beta, SquaredEnergyTransfer) / averages.mean_h, 1,
                kCanonicalAverageError);
  }
}

TEST(CanonicalMeasure, AveragesSatisfyTheIdentities) {
  for (double beta : {1e-3, 1.0, 1e4}) {
    const CanonicalAverages a = AveragesAt(beta);
    EXPECT_DOUBLE_EQ(a.mean_f, 1 / std::sqrt(2 * std::numbers::pi * beta));
    EXPECT_DOUBLE_EQ(a.mean_energy_current * beta * beta / 2, a.mean_f);
    EXPECT_DOUBLE_EQ(a.mean_h * beta * beta / 2, a.mean_f);
  }
}

}  // namespace
}  // namespace ballpiston
