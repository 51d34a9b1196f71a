#include "core/experiment/ensemble_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/pair_geometry.h"

namespace ballpiston {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

EnsembleSpec FirstHit() {
  return {.experiment = Experiment::kFirstHit,
          .grid = {.rho = {0.55, 0.6}, .delta = {0.1}, .epsilon = {0, 0.5}, .exponent = {0, 1, 5}},
          .target = {.samples = 1000}};
}

auto Names(const std::string& field, const std::string& text) {
  return AllOf(Field(&FieldViolation::field, field),
               Field(&FieldViolation::description, HasSubstr(text)));
}

TEST(EnsembleSpec, ValidOnesHaveNoViolations) {
  EXPECT_THAT(Violations(FirstHit()), IsEmpty());
  EXPECT_THAT(Violations({.experiment = Experiment::kEquilibrium,
                          .grid = {.rho = {0.6}, .delta = {PairDeltaBound(0.6)}}}),
              IsEmpty());
}

TEST(EnsembleSpec, GridIsTheProductWithRhoOutermost) {
  const EnsembleSpec spec = FirstHit();
  ASSERT_EQ(PointCount(spec), 12u);
  EXPECT_EQ(PointAt(spec, 0),
            (PointParameters{.rho = 0.55, .delta = 0.1, .epsilon = 0, .exponent = 0}));
  EXPECT_EQ(PointAt(spec, 4),
            (PointParameters{.rho = 0.55, .delta = 0.1, .epsilon = 0.5, .exponent = 1}));
  EXPECT_EQ(PointAt(spec, 11),
            (PointParameters{.rho = 0.6, .delta = 0.1, .epsilon = 0.5, .exponent = 5}));
}

TEST(EnsembleSpec, EveryViolationIsReportedAtOnce) {
  EnsembleSpec spec = FirstHit();
  spec.grid.rho = {0.6, 0.5, kNaN};
  spec.grid.delta = {0.3, -1};
  spec.grid.epsilon = {0.6, -kInfinity};
  spec.grid.exponent = {-1, 1001};
  spec.grid.cells = {4};
  spec.target = {.samples = 0, .tolerance = 0};
  spec.model = Model::kMarkov;
  spec.precision = Precision::kSingle;
  EXPECT_THAT(
      Violations(spec),
      UnorderedElementsAre(Names("grid.rho[1]", "rho is 0.5"), Names("grid.rho[2]", "rho is nan"),
                           Names("grid.delta[0]", "bound of a ball-piston pair"),
                           Names("grid.delta[1]", "-1"), Names("grid.epsilon[0]", "[0, 0.5]"),
                           Names("grid.epsilon[1]", "-inf"), Names("grid.exponent[0]", "[0, 1000]"),
                           Names("grid.exponent[1]", "1001"), Names("grid.cells", "takes none"),
                           Names("target", "more than one"), Names("target.samples", "is 0"),
                           Names("target.tolerance", "0 < tolerance < 1"), Names("model", "markov"),
                           Names("precision", "single")));
}

TEST(EnsembleSpec, DeltaBeyondTheBoundNamesItsValue) {
  EnsembleSpec spec = FirstHit();
  spec.grid.delta = {0.2};  // legal at 0.55, not at 0.6, where the bound is 0.1683
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[0]",
                                                  "rho = 0.6: 0 < delta <= (1 - "
                                                  "lambda)/2 = 0.1683")));
}

TEST(EnsembleSpec, AbsurdGridsAreRefusedWithoutBeingExpanded) {
  EnsembleSpec spec = FirstHit();
  spec.grid.delta.assign(1000, 0.01);
  spec.grid.epsilon.assign(1000, 0.1);
  spec.grid.exponent.assign(1000, 1);
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid", "2000000000 points")));
}

TEST(EnsembleSpec, ListsThatTheExperimentLacksOrDoesNotUseAreNamed) {
  EXPECT_THAT(Violations({.experiment = Experiment::kEquilibrium,
                          .grid = {.delta = {0.1}, .epsilon = {0.1}, .exponent = {1}}}),
              UnorderedElementsAre(Names("grid.rho", "needs at least one"),
                                   Names("grid.epsilon", "takes none"),
                                   Names("grid.exponent", "takes none")));
}

TEST(EnsembleSpec, TargetsThatTheExperimentDoesNotCountAreRefused) {
  EnsembleSpec spec = FirstHit();
  spec.target = {.collisions = 10};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.collisions", "use target.samples")));
  spec.target = {.budget_seconds = 10};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.budget", "not offered")));
  spec.target = {.samples = kMaxSamples + 1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.samples", "permitted: 1 to")));
  spec.grid.epsilon = {0.5};
  for (const double tolerance : {0.0, -0.1, 1.0, kNaN, kInfinity}) {
    spec.target = {.tolerance = tolerance};
    EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "0 < tolerance < 1")));
  }
}

TEST(EnsembleSpec, DeltaWhoseTimesLeaveTheRangeOfDoubleIsRefused) {
  EnsembleSpec spec = FirstHit();
  spec.grid.delta = {0.1, 1e-160, std::numeric_limits<double>::denorm_min()};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[1]", "too small"),
                                            Names("grid.delta[2]", "too small")));
}

TEST(EnsembleSpec, ToleranceThatCannotBeReachedIsRefused) {
  EnsembleSpec spec = FirstHit();
  spec.target = {.tolerance = 0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "epsilon = 0")));
}

TEST(EnsembleSpec, MissingExperimentIsNamed) {
  EXPECT_THAT(Violations({}), Contains(Names("experiment", "permitted: equilibrium")));
}

}  // namespace
}  // namespace ballpiston
