// A grid whose points stand in a table.
#include "core/ensemble/ensemble_spec.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "core/model_choice/ladder.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec TableOf(std::vector<double> rho, std::vector<double> delta) {
  EnsembleSpec spec = {.experiment = &kFirstHit,
                       .grid = {{kRho, std::move(rho)},
                                {kDelta, std::move(delta)},
                                {kEpsilon, {0.125, 0.25}},
                                {kExponent, {1}}},
                       .target = {.samples = 100}};
  spec.grid.MakeColumn(kRho);
  spec.grid.MakeColumn(kDelta);
  return spec;
}

auto OfField(const char* field) { return Field(&FieldViolation::field, field); }

TEST(TableOfPoints, IsMultipliedByTheOtherListsAndVariesSlowest) {
  const EnsembleSpec spec = TableOf({0.53, 0.6, 0.55}, {0.2, 0.05, 0.1});
  ASSERT_THAT(Violations(spec), IsEmpty());
  ASSERT_EQ(PointCount(spec), 6u);
  EXPECT_EQ(PointAt(spec, 1),
            (PointParameters{{kRho, 0.53}, {kDelta, 0.2}, {kEpsilon, 0.25}, {kExponent, 1}}));
  EXPECT_EQ(PointAt(spec, 4),
            (PointParameters{{kRho, 0.55}, {kDelta, 0.1}, {kEpsilon, 0.125}, {kExponent, 1}}));
}

TEST(TableOfPoints, APointHasTheAnswerThatItHasAlone) {
  const EnsembleSpec spec = TableOf({0.53, 0.6}, {0.2, 0.05});
  const EnsembleSpec alone = OnePointSpec(spec, PointAt(spec, 2), Model::kBilliard);
  EXPECT_EQ(RunPoint(spec, 2).estimates[0].value, RunPoint(alone).estimates[0].value);
}

// delta = 0.3 is permitted beside rho = 0.53, but not beside 0.6.
TEST(TableOfPoints, AValueIsCheckedBesideThoseOfItsRow) {
  EXPECT_THAT(Violations(TableOf({0.53, 0.6}, {0.3, 0.05})), IsEmpty());
  EXPECT_THAT(Violations(TableOf({0.53, 0.6}, {0.05, 0.3})), ElementsAre(OfField("grid.delta[1]")));
}

TEST(TableOfPoints, HotIsComparedWithTheColdOfItsRow) {
  EnsembleSpec spec = {.experiment = &kGasConduction,
                       .grid = {{kRho, {0.53}},
                                {kDelta, {0.1}},
                                {kCells, {CodeOf({.columns = 2})}},
                                {kHot, {1, 3}},
                                {kCold, {0.5, 2}}}};
  EXPECT_THAT(Violations(spec), ElementsAre(OfField("grid.hot[0]")));
  spec.grid.MakeColumn(kHot);
  spec.grid.MakeColumn(kCold);
  EXPECT_THAT(Violations(spec), IsEmpty());
  spec.grid[kHot] = {1, 2};
  spec.target = {.tolerance = 0.1};
  EXPECT_THAT(AnswerViolations(spec), ElementsAre(OfField("target.tolerance")));
}

TEST(TableOfPoints, ColumnsAreEquallyLong) {
  EXPECT_THAT(Violations(TableOf({0.53, 0.6}, {0.05})), ElementsAre(OfField("grid.delta")));
  EXPECT_THAT(Violations(TableOf({}, {0.05})), testing::Contains(OfField("grid.rho")));
  EXPECT_THAT(Violations(TableOf({}, {})), testing::Contains(OfField("grid.rho")));
}

}  // namespace
}  // namespace ballpiston
