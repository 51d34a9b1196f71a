#include "core/geometry/pair_geometry.h"

#include "core/arithmetic/number_text.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr double kRadii[] = {0.5 + 1e-12, 0.501, kPaperRho, 0.6, 0.7, kMaxRho - 1e-7};

// Tolerances: two ulps of numbers of order one.
TEST(PairGeometry, DerivedLengthsMatchTheCell) {
  for (const double rho : kRadii) {
    ASSERT_OK_AND_ASSIGN(const PairGeometry g,
                         PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho)));
    EXPECT_EQ(g.rho(), rho);
    EXPECT_NEAR(g.lambda() * g.lambda(), 4 * rho * rho - 1, 4e-16);
    EXPECT_NEAR(g.tip(), 0.5 - g.lambda() / 2, 2e-16);
    EXPECT_NEAR(std::hypot(g.tip() - 0.5, 0.5), rho, 2e-16);  // on the disc
    EXPECT_NEAR(g.piston_left(), g.tip() - g.delta(), 2e-16);
    EXPECT_NEAR(g.piston_right() - g.piston_left(), g.lambda() + 2 * g.delta(), 4e-16);
  }
}

// A value that a user has rounded up counts as the bound.
TEST(PairGeometry, DeltaUpToTheBoundIsAccepted) {
  EXPECT_OK(PairGeometry::Create(0.6, std::numeric_limits<double>::denorm_min()));
  for (const double rho : {std::nextafter(0.5, 1.0), 0.501, kPaperRho, 0.6, 0.7}) {
    const double bound = PairDeltaBound(rho);
    for (const double delta : {bound, bound * (1 + 9e-13)}) {
      ASSERT_OK_AND_ASSIGN(const PairGeometry g, PairGeometry::Create(rho, delta));
      EXPECT_EQ(g.delta(), bound);
      EXPECT_EQ(g.piston_left(), 0);
    }
    EXPECT_THAT(PairGeometry::Create(rho, bound * (1 + 2e-12)),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("delta")));
  }
}

TEST(PairGeometry, ValuesOutsideOfTheirIntervalsAreNamedWithTheBound) {
  for (const double rho : {0.5, kMaxRho, 0.0, -0.6, 1.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    const auto is_named =
        StatusIs(absl::StatusCode::kInvalidArgument,
                 AllOf(HasSubstr("rho is " + NumberText(rho)), HasSubstr("1/2 < rho < 1/sqrt(2)"),
                       HasSubstr(NumberText(kMaxRho)), Not(HasSubstr("delta"))));
    EXPECT_THAT(PairGeometry::Create(rho, -1), is_named);
    EXPECT_THAT(ValidateRho(rho), is_named);
  }
  for (const double delta : {0.0, -0.0, -0.1, 0.33, 1.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    const auto is_named =
        StatusIs(absl::StatusCode::kInvalidArgument,
                 AllOf(HasSubstr("delta is " + NumberText(delta)), HasSubstr("(1 - lambda)/2"),
                       HasSubstr(NumberText(PairDeltaBound(kPaperRho)))));
    EXPECT_THAT(PairGeometry::Create(kPaperRho, delta), is_named);
    EXPECT_THAT(ValidatePairDelta(kPaperRho, delta), is_named);
  }
}

}  // namespace
}  // namespace ballpiston
