// What a specification may ask: tables of permitted and of rejected questions, and the numbers that
// follow from a specification.
#include "core/ensemble/ensemble_spec.h"

#include "core/ensemble/parameter.h"
#include "core/ensemble/point_experiment.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/temperature.h"
#include "core/model_choice/ladder.h"
#include "tests/core/asked.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr Model kReducedModels[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov};
EnsembleSpec At(const ExperimentKind* experiment, double rho, double delta) {
  EnsembleSpec spec = OnePointOf(experiment);
  spec.grid[kRho] = {rho};
  spec.grid[kDelta] = {delta};
  return spec;
}

// ---- tables ----

struct Row {
  std::string question;
  // "field: a part of what is said about it"; empty if the question is permitted.
  std::vector<std::string> violations = {};
};

void ExpectViolations(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    std::vector<testing::Matcher<const FieldViolation&>> expected;
    for (const std::string& violation : row.violations) {
      const std::vector<std::string> sides = absl::StrSplit(violation, absl::MaxSplits(": ", 1));
      expected.emplace_back(Names(sides.at(0), sides.at(1)));
    }
    EXPECT_THAT(Violations(Asked(row.question)), testing::UnorderedElementsAreArray(expected))
        << row.question;
  }
}

TEST(EnsembleSpec, ListsAreChecked) {
  ExpectViolations({
      {"first-hit rho=0.55,0.6 delta=0.2",
       {"grid.delta[0]: rho = 0.6: 0 < delta <= (1 - lambda)/2 = 0.1683"}},
      {"first-hit rho=0.6 delta=0.5,inf",
       {"grid.delta[0]: rho = 0.6: 0 < delta <= (1 - lambda)/2 = 0.1683",
        "grid.delta[1]: rho = 0.6"}},
      {"equilibrium rho=", {"grid.rho: needs at least one"}},
      {"equilibrium epsilon=0.1 exponent=1",
       {"grid.epsilon: does not use this list", "grid.exponent: does not use this list"}},
      {"gas-equilibrium hot=2 epsilon=0.1",
       {"grid.hot: does not use this list", "grid.epsilon: does not use this list"}},
      {"gas-conduction temperature=1", {"grid.temperature: gas-conduction does not use this list"}},
      // Times outside of the range of a double. The smallest radius decides.
      {"first-hit delta=0.1,1e-36,5e-324",
       {"grid.delta[1]: is 1e-36, too small", "grid.delta[2]: too small"}},
      {"first-hit rho=0.6,0.50000000000000011 delta=1e-33", {"grid.delta[0]: too small"}},
      {"equilibrium delta=1e-33"},  // by the closed form
      {"gas-conduction hot=2,0.5,1,0.99999999999999989 cold=1",
       {"grid.hot[1]: hot is 0.5, below cold = 1; permitted: hot >= cold",
        "grid.hot[3]: below cold = 1"}},
      {"gas-conduction hot=2 cold=nan,3,1", {"grid.cold[0]: nan"}},  // combinations come later
  });
  EXPECT_THAT(Violations(At(&kEquilibrium, kPaperRho, PairDeltaBound(kPaperRho))), IsEmpty());
}

// Combinations of values are left out: they are checked when each value by itself is permitted.
TEST(EnsembleSpec, EveryViolationIsReportedAtOnce) {
  ExpectViolations(
      {{"first-hit rho=0.6,0.5,nan delta=0.3,-1 epsilon=0.6,-inf exponent=-1,1001 cells=4 "
        "temperature=1,2,-1 hot=1 cold=1,0 samples=0 tolerance=0 model=markov precision=single",
        {"grid.rho[1]: rho is 0.5", "grid.rho[2]: rho is nan", "grid.delta[1]: -1",
         "grid.epsilon[0]: [0, 0.5]", "grid.epsilon[1]: -inf", "grid.exponent[0]: [0, 1000]",
         "grid.exponent[1]: 1001", "grid.cells: does not use this list",
         "grid.temperature: has 3 values; first-hit does not use this list",
         "grid.temperature[2]: temperature is -1",
         "grid.hot: has 1 value; first-hit does not use this list", "grid.cold: has 2 values",
         "grid.cold[1]: cold is 0", "target: more than one", "target.samples: is 0",
         "target.tolerance: 0 < tolerance < 1", "model: markov", "precision: single"}}});
}

TEST(EnsembleSpec, HugeGridsAreRejectedWithoutExpansion) {
  EnsembleSpec spec = OnePointOf(&kFirstHit);
  spec.grid[kDelta].assign(1000, 0.01);
  spec.grid[kEpsilon].assign(1000, 0.1);
  spec.grid[kExponent].assign(2000, 1);
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid", "2000000000 points")));
  spec.grid[kEpsilon].resize(100);
  spec.grid[kExponent].resize(1);
  EXPECT_THAT(Violations(spec), IsEmpty());  // kMaxPoints
  spec.grid[kDelta].push_back(0.01);
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid", "100100 points")));
}

TEST(EnsembleSpec, TargetsAreChecked) {
  ExpectViolations({
      {"first-hit samples=1"},
      {"first-hit samples=1e12"},
      {"first-hit samples=1e13", {"target.samples: permitted: 1 to 1000000000000"}},
      {"first-hit samples=-1", {"target.samples: is -1; permitted: 1 to"}},
      {"first-hit collisions=-1", {"target.collisions: is -1; permitted: 1 to"}},
      {"gas-conduction delta=1e-10 collisions=1e6 model=billiard",
       {"target.collisions: is 1000000, but a sample has"}},
      {"energy-relaxation samples=10 budget=1", {"target.budget: alone, or with a tolerance"}},
      {"energy-relaxation collisions=10 budget=1", {"target.budget: alone, or with a tolerance"}},
      {"energy-relaxation samples=10 tolerance=0.1", {"target: more than one kind"}},
      {"energy-relaxation budget=0", {"target.budget: 0 < budget <= 1"}},
      {"energy-relaxation budget=1e99", {"target.budget: 0 < budget <= 1"}},
      {"energy-relaxation budget=nan", {"target.budget: 0 < budget <= 1"}},
      {"first-hit tolerance=1", {"target.tolerance: 0 < tolerance < 1"}},
      {"first-hit tolerance=nan", {"target.tolerance: 0 < tolerance < 1"}},
      {"first-hit tolerance=-0.01", {"target.tolerance: is -0.01; permitted: 0 < tolerance < 1"}},
  });
  EnsembleSpec longest = OnePointOf(&kEnergyRelaxation);
  longest.target = {.budget_seconds = kMaxBudgetSeconds};
  EXPECT_THAT(Violations(longest), IsEmpty());
}

TEST(EnsembleSpec, NamedEstimatesAreChecked) {
  ExpectViolations({
      {"gas-equilibrium estimate=conductivity model=closed_form",
       {"target.estimate: is conductivity, which model closed_form cannot answer; permitted: "
        "exchange_rate, or model auto, spectrum, markov, billiard, billiard_reference"}},
      {"gas-equilibrium estimate=Conductivity",
       {"target.estimate: is Conductivity; permitted with gas-equilibrium: exchange_rate, "
        "conductivity"}},
      {"gas-equilibrium estimate=temperature_ball", {"target.estimate: is temperature_ball"}},
      {"first-hit tolerance=2 estimate=conductivity",
       {"target.estimate: first-hit", "target.tolerance: is 2"}},
      // A model that answers no estimate of the experiment is one violation.
      {"first-hit estimate=mean_hit_time model=markov", {"model: cannot answer first-hit"}},
  });
}

// ---- models and their domains ----

TEST(EnsembleSpec, ModelsThatDoNotAnswerAreRejectedWithTheOthers) {
  for (const ExperimentKind* experiment : AllExperiments()) {
    for (const Model model : kAllModels) {
      EnsembleSpec spec = OnePointOf(experiment);
      spec.model = model;
      EXPECT_EQ(Violations(spec).empty(), experiment->IsAnsweredBy(model)) << experiment->name;
    }
  }
  ExpectViolations(
      {{"first-hit model=markov", {"model: permitted: auto, billiard, billiard_reference"}},
       {"markov-property model=spectrum", {"model: cannot answer markov-property"}}});
  EXPECT_THAT(Violations({}), Contains(Names("experiment", "energy-relaxation, markov-property")));
}

TEST(EnsembleSpec, PrecisionAndVerifyAreForSomeModels) {
  ExpectViolations({
      {"energy-relaxation precision=single model=spectrum", {"precision: spectrum"}},
      {"energy-relaxation precision=single model=markov", {"precision: markov"}},
      {"energy-relaxation precision=single model=billiard_reference",
       {"precision: billiard_reference"}},
      {"gas-equilibrium precision=single", {"precision: is single; permitted for a gas: double"}},
      {"gas-conduction precision=single", {"precision: is single; permitted for a gas: double"}},
      {"equilibrium verify=yes model=closed_form", {"verify: permitted with model auto"}},
      {"equilibrium verify=yes model=billiard", {"verify: permitted with model auto"}},
  });
}

// Beyond this domain rounding makes the billiard wrong (billiard/billiard_domain.h).
TEST(EnsembleSpec, BilliardIsRejectedOutsideItsDomain) {
  const double inside = kMaxRho - 1.1e-9, outside = kMaxRho - 0.9e-9;
  for (const ExperimentKind* experiment : AllExperiments()) {
    SCOPED_TRACE(experiment->name);
    for (const Model model : {Model::kBilliard, Model::kBilliardReference}) {
      EnsembleSpec spec = At(experiment, inside, 1.01e-10);
      spec.model = model;
      EXPECT_THAT(Violations(spec), IsEmpty());
      spec.grid[kRho] = {inside, outside};
      spec.grid[kDelta] = {0.99e-10, 1.01e-10};
      EXPECT_THAT(Violations(spec),
                  ElementsAre(Names("grid.rho[1]", "billiard_reference: 0.5 < rho <= 0.7071067801"),
                              Names("grid.delta[0]", "billiard_reference: delta >= 1e-10")));
    }
    for (const Model model : kReducedModels) {
      if (!experiment->IsAnsweredBy(model)) continue;
      EnsembleSpec spec = At(experiment, outside, 0.99e-10);
      spec.model = model;
      EXPECT_THAT(Violations(spec), IsEmpty());
    }
  }
  ExpectViolations(
      {{"markov-property delta=1e-12 model=billiard", {"grid.delta[0]: markov-property: markov"}},
       {"first-hit delta=1e-12 model=billiard",
        {"grid.delta[0]: no other model answers first-hit"}}});
}

// Outside of this domain the errors of single precision are unknown (billiard/billiard_domain.h).
TEST(EnsembleSpec, SinglePrecisionIsRejectedOutsideItsMeasuredDomain) {
  for (const ExperimentKind* experiment : AllExperiments()) {
    if (IsOfAGas(experiment)) continue;  // it has no single precision
    EnsembleSpec spec = OnePointOf(experiment);
    spec.precision = Precision::kSingle;
    spec.grid[kRho] = {0.5 + 0.9e-5, 0.5 + 1.1e-5, kMaxRho - 1.1e-3, kMaxRho - 0.9e-3};
    spec.grid[kDelta] = {0.9e-3, 1e-3};
    EXPECT_THAT(
        Violations(spec),
        UnorderedElementsAre(Names("grid.rho[0]", "permitted with precision single: 0.5"),
                             Names("grid.rho[3]", "rho <= 0.7061"),
                             Names("grid.delta[0]", "with precision double: delta >= 1e-10")));
    spec.precision = Precision::kDouble;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
  ExpectViolations({{"first-hit epsilon=0,0.9e-12,1e-12 precision=single",
                     {"grid.epsilon[1]: epsilon = 0 or epsilon >= 1e-12"}}});
}

// The largest rho decides, and the pair's bound is larger.
TEST(EnsembleSpec, GasesHaveTheirOwnBounds) {
  for (const std::string gas : {"gas-equilibrium", "gas-conduction"}) {
    ExpectViolations({
        {gas + " rho=0.529561127988977 delta=0.2"},
        {gas + " rho=0.529561127988977,0.6 delta=0.09,0.1,0.16",
         {"grid.delta[1]: rho = 0.6: 0 < delta <= rho/sqrt(2) - lambda/2 = 0.0926",
          "grid.delta[2]: the bound of a gas, where no two pistons may overlap"}},
        {gas + " delta=1e-160", {"grid.delta[0]: too small"}},
        {gas + " cells=", {"grid.cells: needs at least one"}},
    });
  }
}

// An experiment that limits the number of cells does not count those of an invalid shape, so there
// is no second violation.
TEST(EnsembleSpec, AnInvalidShapeIsReportedOnce) {
  const std::vector<std::string> rejected = {"grid.cells[0]: 1 to 1000000"};
  ExpectViolations({{"gas-lyapunov cells=32"},
                    {"gas-lyapunov cells=33",
                     {"grid.cells[0]: is 33; permitted for gas-lyapunov: 1 to 32 cells"}},
                    {"gas-lyapunov cells=1e15", rejected},
                    {"gas-equilibrium estimate=conductivity cells=1e15", rejected}});
}

TEST(EnsembleSpec, TheTemperatureOfAGasIsOneByDefault) {
  EXPECT_THAT(Violations(Asked("gas-equilibrium temperature=")), IsEmpty());
  EXPECT_EQ(PointAt(Asked("gas-equilibrium temperature="), 0),
            PointAt(Asked("gas-equilibrium temperature=1"), 0));
}

// ---- points and samples ----

TEST(EnsembleSpec, GridIsTheProductWithRhoOutermost) {
  EnsembleSpec spec = OnePointOf(&kFirstHit);
  spec.grid = {{kRho, {0.55, 0.6}}, {kDelta, {0.1}}, {kEpsilon, {0, 0.5}}, {kExponent, {0, 1, 5}}};
  ASSERT_EQ(PointCount(spec), 12u);
  const auto point = [](double rho, double epsilon, double exponent) {
    return PointParameters{{kRho, rho}, {kDelta, 0.1}, {kEpsilon, epsilon}, {kExponent, exponent}};
  };
  EXPECT_EQ(PointAt(spec, 0), point(0.55, 0, 0));
  EXPECT_EQ(PointAt(spec, 4), point(0.55, 0.5, 1));
  EXPECT_EQ(PointAt(spec, 11), point(0.6, 0.5, 5));
}

TEST(EnsembleSpec, OnePointSpecHasItsShareOfTheBudget) {
  const EnsembleSpec spec = Asked("gas-equilibrium delta=0.1,0.05,0.02 budget=6");
  const EnsembleSpec one = OnePointSpec(spec, PointAt(spec, 1), Model::kBilliard);
  EXPECT_EQ(PointCount(one), 1u);
  EXPECT_EQ(PointAt(one, 0), PointAt(spec, 1));
  EXPECT_EQ(one.target.budget_seconds, 2);
}

// A message states the largest permitted number of collisions.
TEST(EnsembleSpec, ThePermittedCollisionsAreThoseOfTheLargestNumberOfSamples) {
  EnsembleSpec spec = Asked("gas-conduction rho=0.53 hot=2 cold=1");
  spec.model = Model::kBilliard;
  spec.grid[kDelta] = {0.1, 1e-6};
  spec.target = {.collisions = kMaxSamples};
  const std::vector<FieldViolation> found = Violations(spec);
  ASSERT_EQ(found.size(), 1u);
  const size_t permitted = found[0].description.find("permitted: 1 to ");
  ASSERT_NE(permitted, std::string::npos) << found[0].description;
  spec.target.collisions = std::stoll(found[0].description.substr(permitted + 16));
  EXPECT_THAT(Violations(spec), IsEmpty());
  ++*spec.target.collisions;
  EXPECT_EQ(Violations(spec).size(), 1u);
  spec.grid[kDelta] = {1e-10};
  EXPECT_EQ(SamplesAskedFor(spec.target, ForecastOf(spec, PointAt(spec, 0))),
            static_cast<uint64_t>(kMaxSamples));
}

// ---- a grid whose points stand in a table ----

EnsembleSpec TableOf(const std::vector<double>& rho, const std::vector<double>& delta) {
  EnsembleSpec spec = Asked("first-hit epsilon=0.125,0.25 samples=100");
  spec.grid[kRho] = rho;
  spec.grid[kDelta] = delta;
  spec.grid.MakeColumn(kRho);
  spec.grid.MakeColumn(kDelta);
  return spec;
}

TEST(TableOfPoints, IsMultipliedByTheOtherListsAndVariesSlowest) {
  const EnsembleSpec spec = TableOf({0.53, 0.6, 0.55}, {0.2, 0.05, 0.1});
  ASSERT_THAT(Violations(spec), IsEmpty());
  ASSERT_EQ(PointCount(spec), 6u);
  EXPECT_EQ(PointAt(spec, 1),
            (PointParameters{{kRho, 0.53}, {kDelta, 0.2}, {kEpsilon, 0.25}, {kExponent, 1}}));
  EXPECT_EQ(PointAt(spec, 4),
            (PointParameters{{kRho, 0.55}, {kDelta, 0.1}, {kEpsilon, 0.125}, {kExponent, 1}}));
}

// delta = 0.3 is permitted beside rho = 0.53, but not beside 0.6.
TEST(TableOfPoints, AValueIsCheckedBesideThoseOfItsRow) {
  EXPECT_THAT(Violations(TableOf({0.53, 0.6}, {0.3, 0.05})), IsEmpty());
  EXPECT_THAT(Violations(TableOf({0.53, 0.6}, {0.05, 0.3})), ElementsAre(OfField("grid.delta[1]")));
}

TEST(TableOfPoints, HotIsComparedWithTheColdOfItsRow) {
  EnsembleSpec spec = Asked("gas-conduction rho=0.53 hot=1,3 cold=0.5,2");
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
  EXPECT_THAT(Violations(TableOf({}, {0.05})), Contains(OfField("grid.rho")));
  EXPECT_THAT(Violations(TableOf({}, {})), Contains(OfField("grid.rho")));
}

// ---- parameter.h ----

TEST(Parameter, OnlyCodesOfShapesAreTheValuesOfCells) {
  constexpr double kRow = 0x1p20;  // the code of a lattice without columns
  for (const double value : {0.0, -1.0, 0.5, 12.5, 1e6 + 1, kRow - 1, kRow, kRow + 0.5, 3 * kRow,
                             CodeOf({.columns = 1001, .rows = 1000, .is_lattice = true}),
                             CodeOf({.columns = 1, .rows = 1'000'001, .is_lattice = true}), 0x1p41,
                             0x1p63, 1e300, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_THAT(kCells.Validate(value),
                StatusIs(absl::StatusCode::kInvalidArgument,
                         HasSubstr("permitted: codes of N or NxM, 1 to 1000000 cells in all")))
        << value;
  }
  EXPECT_THAT(kCells.Validate(0.5).message(), HasSubstr("cells is the code 0.5; "));
}

TEST(Parameter, RangesAreClosedToTheLastBit) {
  const std::tuple<const Parameter*, double, double, const char*> kRanges[] = {
      {&kEpsilon, 0, 0.5, "[0, 0.5]"},
      {&kExponent, 0, kMaxExponent, "[0, 1000]"},
      {&kTemperature, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"},
      {&kHot, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"},
      {&kCold, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"}};
  for (const auto& [parameter, lower, upper, permitted] : kRanges) {
    for (const double value : {lower, 0.25, upper}) {
      EXPECT_OK(parameter->Validate(value)) << parameter->name;
    }
    for (const double value : {std::nextafter(lower, -HUGE_VAL), std::nextafter(upper, HUGE_VAL),
                               HUGE_VAL, -HUGE_VAL, std::nan("")}) {
      EXPECT_THAT(parameter->Validate(value), StatusIs(absl::StatusCode::kInvalidArgument))
          << parameter->name << " " << value;
    }
    EXPECT_EQ(parameter->Validate(-1).message(),
              absl::StrCat(parameter->name, " is -1; permitted: ", permitted));
  }
}

TEST(Grid, APointHasZeroForMinusZero) {
  const Grid grid = {{kEpsilon, {-0.0, 0.0}}};
  EXPECT_FALSE(std::signbit(grid.PointAt(0)[kEpsilon]));
}

}  // namespace
}  // namespace ballpiston
