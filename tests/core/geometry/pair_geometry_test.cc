#include "core/geometry/pair_geometry.h"

#include <cmath>
#include <limits>
#include <string>

#include "core/arithmetic/number_text.h"
#include "core/geometry/paper.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/status_matchers.h"

namespace ballpiston {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Message(double rho, double delta) {
  const auto geometry = PairGeometry::Create(rho, delta);
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(geometry.status().message());
}

TEST(PairGeometry, DerivedLengthsMatchTheCell) {
  ASSERT_OK_AND_ASSIGN(const PairGeometry g, PairGeometry::Create(kPaperRho, 0.175));
  EXPECT_EQ(g.rho(), kPaperRho);
  EXPECT_EQ(g.delta(), 0.175);
  // Tolerances: two ulps of numbers of order one.
  EXPECT_NEAR(g.lambda() * g.lambda(), 4 * kPaperRho * kPaperRho - 1, 4e-16);
  EXPECT_NEAR(g.tip(), 0.5 - g.lambda() / 2, 2e-16);
  EXPECT_NEAR(g.piston_left(), g.tip() - 0.175, 2e-16);
  EXPECT_NEAR(g.piston_right() - g.piston_left(), g.lambda() + 0.35, 4e-16);
}

TEST(PairGeometry, TipLiesOnTheDisc) {
  for (double rho : {0.5 + 1e-12, 0.501, kPaperRho, 0.6, 0.7, kMaxRho - 1e-7}) {
    const double tip = PairDeltaBound(rho);
    EXPECT_NEAR(std::hypot(tip - 0.5, 0.5), rho, 2e-16) << rho;
  }
}

TEST(PairGeometry, PaperValuesOfTheBounds) {
  // At the paper's radius the gas bound is 1/5 by construction, rho having 15 digits there.
  EXPECT_NEAR(GasDeltaBound(kPaperRho), 0.2, 1e-14);
  EXPECT_LE(0.2, GasDeltaBound(kPaperRho) * (1 + kDeltaSlack));
  EXPECT_NEAR(PairDeltaBound(kPaperRho), 0.32554373534619712, 1e-15);
}

TEST(PairGeometry, GasBoundIsTheTighterOne) {
  for (double rho : {0.5 + 1e-12, 0.501, kPaperRho, 0.6, 0.7, kMaxRho - 1e-7}) {
    EXPECT_LT(GasDeltaBound(rho), PairDeltaBound(rho)) << rho;
    EXPECT_GT(GasDeltaBound(rho), 0) << rho;
  }
}

TEST(PairGeometry, DeltaExactlyAtTheBoundIsAccepted) {
  for (double rho : {std::nextafter(0.5, 1.0), 0.501, kPaperRho, 0.6, 0.7, kMaxRho - 1e-7}) {
    const double bound = PairDeltaBound(rho);
    ASSERT_OK_AND_ASSIGN(const PairGeometry g, PairGeometry::Create(rho, bound));
    EXPECT_EQ(g.piston_left(), 0);
    // A value that a user has rounded up counts as the bound.
    ASSERT_OK_AND_ASSIGN(const PairGeometry rounded,
                         PairGeometry::Create(rho, bound * (1 + 9e-13)));
    EXPECT_EQ(rounded.delta(), bound);
    EXPECT_EQ(rounded.piston_left(), 0);
    EXPECT_THAT(PairGeometry::Create(rho, bound * (1 + 2e-12)),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("delta")));
  }
}

TEST(PairGeometry, SmallestDeltaIsAccepted) {
  EXPECT_OK(PairGeometry::Create(0.6, std::numeric_limits<double>::denorm_min()));
}

TEST(PairGeometry, RhoOutsideOfItsOpenIntervalIsNamed) {
  for (double rho : {0.5, kMaxRho, 0.0, -0.6, 1.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_THAT(Message(rho, 0.1),
                AllOf(HasSubstr("rho is " + NumberText(rho)), HasSubstr("1/2 < rho < 1/sqrt(2)"),
                      HasSubstr(NumberText(kMaxRho))));
  }
}

TEST(PairGeometry, DeltaOutsideOfItsIntervalIsNamedWithTheBound) {
  for (double delta : {0.0, -0.0, -0.1, 0.33, 1.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_THAT(Message(kPaperRho, delta),
                AllOf(HasSubstr("delta is " + NumberText(delta)), HasSubstr("(1 - lambda)/2"),
                      HasSubstr(NumberText(PairDeltaBound(kPaperRho)))));
  }
}

TEST(PairGeometry, InvalidRhoIsReportedBeforeDelta) {
  EXPECT_THAT(Message(0.4, -1), AllOf(HasSubstr("rho is"), ::testing::Not(HasSubstr("delta"))));
}

TEST(PairGeometry, ValidatorsAgreeWithCreate) {
  EXPECT_OK(ValidateRho(kPaperRho));
  EXPECT_OK(ValidatePairDelta(kPaperRho, 0.325));
  EXPECT_EQ(std::string(ValidateRho(0.5).message()), Message(0.5, 0.1));
  EXPECT_EQ(std::string(ValidatePairDelta(0.6, 0.3).message()), Message(0.6, 0.3));
}

}  // namespace
}  // namespace ballpiston
