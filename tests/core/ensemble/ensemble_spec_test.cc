#include "core/ensemble/ensemble_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "core/ensemble/point_experiment.h"
#include "core/experiment/all_experiments.h"
#include "core/geometry/pair_geometry.h"
#include "tests/core/one_point_spec.h"

namespace ballpiston {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

EnsembleSpec ValidFirstHit() {
  return {
      .experiment = &kFirstHit,
      .grid = {{kRho, {0.55, 0.6}}, {kDelta, {0.1}}, {kEpsilon, {0, 0.5}}, {kExponent, {0, 1, 5}}},
      .target = {.samples = 1000}};
}

auto Names(const std::string& field, const std::string& text) {
  return AllOf(Field(&FieldViolation::field, field),
               Field(&FieldViolation::description, HasSubstr(text)));
}

TEST(EnsembleSpec, ValidSpecsHaveNoViolations) {
  EXPECT_THAT(Violations(ValidFirstHit()), IsEmpty());
  EXPECT_THAT(Violations({.experiment = &kEquilibrium,
                          .grid = {{kRho, {0.6}}, {kDelta, {PairDeltaBound(0.6)}}}}),
              IsEmpty());
}

TEST(EnsembleSpec, GridIsTheProductWithRhoOutermost) {
  const EnsembleSpec spec = ValidFirstHit();
  ASSERT_EQ(PointCount(spec), 12u);
  EXPECT_EQ(PointAt(spec, 0),
            (PointParameters{{kRho, 0.55}, {kDelta, 0.1}, {kEpsilon, 0}, {kExponent, 0}}));
  EXPECT_EQ(PointAt(spec, 4),
            (PointParameters{{kRho, 0.55}, {kDelta, 0.1}, {kEpsilon, 0.5}, {kExponent, 1}}));
  EXPECT_EQ(PointAt(spec, 11),
            (PointParameters{{kRho, 0.6}, {kDelta, 0.1}, {kEpsilon, 0.5}, {kExponent, 5}}));
}

TEST(EnsembleSpec, OnePointSpecHasItsShareOfTheBudget) {
  EnsembleSpec spec = ValidFirstHit();
  spec.target = {.budget_seconds = 6};
  spec.seed = 5;
  spec.precision = Precision::kSingle;
  const PointParameters point = PointAt(spec, 4);
  const EnsembleSpec one = OnePointSpec(spec, point, Model::kBilliard);
  EXPECT_EQ(PointCount(one), 1u);
  EXPECT_EQ(PointAt(one, 0), point);
  EXPECT_EQ(one.target.budget_seconds, 0.5);  // of 12
  EXPECT_EQ(one.experiment, spec.experiment);
  EXPECT_EQ(one.seed, 5u);
  EXPECT_EQ(one.model, Model::kBilliard);
  EXPECT_EQ(one.precision, Precision::kSingle);
  EXPECT_THAT(Violations(one), IsEmpty());
  spec.target = {.samples = 6};
  EXPECT_EQ(OnePointSpec(spec, point, Model::kBilliard).target.samples, 6);
}

TEST(EnsembleSpec, EveryViolationIsReportedAtOnce) {
  EnsembleSpec spec = ValidFirstHit();
  spec.grid[kRho] = {0.6, 0.5, std::nan("")};
  spec.grid[kDelta] = {0.3, -1};
  spec.grid[kEpsilon] = {0.6, -HUGE_VAL};
  spec.grid[kExponent] = {-1, 1001};
  spec.grid[kCells] = {4};
  spec.grid[kTemperature] = {1, 2, -1};
  spec.grid[kHot] = {1};
  spec.grid[kCold] = {1, 0};
  spec.target = {.samples = 0, .tolerance = 0};
  spec.model = Model::kMarkov;
  spec.precision = Precision::kSingle;
  EXPECT_THAT(Violations(spec),
              UnorderedElementsAre(
                  Names("grid.rho[1]", "rho is 0.5"), Names("grid.rho[2]", "rho is nan"),
                  Names("grid.delta[0]", "bound of a ball-piston pair"),
                  Names("grid.delta[1]", "-1"), Names("grid.epsilon[0]", "[0, 0.5]"),
                  Names("grid.epsilon[1]", "-inf"), Names("grid.exponent[0]", "[0, 1000]"),
                  Names("grid.exponent[1]", "1001"), Names("grid.cells", "does not use this list"),
                  Names("grid.temperature", "has 3 values; first-hit does not use this list"),
                  Names("grid.temperature[2]", "temperature is -1"),
                  Names("grid.hot", "has 1 values; first-hit does not use this list"),
                  Names("grid.cold", "has 2 values; first-hit does not use this list"),
                  Names("grid.cold[1]", "cold is 0"), Names("target", "more than one"),
                  Names("target.samples", "is 0"), Names("target.tolerance", "0 < tolerance < 1"),
                  Names("model", "markov"), Names("precision", "single")));
}

TEST(EnsembleSpec, DeltaBeyondTheBoundNamesItsValue) {
  EnsembleSpec spec = ValidFirstHit();
  spec.grid[kDelta] = {0.2};  // valid at rho = 0.55; at 0.6 the bound is 0.1683
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[0]",
                                                  "rho = 0.6: 0 < delta <= (1 - "
                                                  "lambda)/2 = 0.1683")));
}

TEST(EnsembleSpec, HugeGridsAreRejectedWithoutExpansion) {
  EnsembleSpec spec = ValidFirstHit();
  spec.grid[kDelta].assign(1000, 0.01);
  spec.grid[kEpsilon].assign(1000, 0.1);
  spec.grid[kExponent].assign(1000, 1);
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid", "2000000000 points")));
}

TEST(EnsembleSpec, MissingAndUnusedListsAreNamed) {
  EXPECT_THAT(Violations({.experiment = &kEquilibrium,
                          .grid = {{kDelta, {0.1}}, {kEpsilon, {0.1}}, {kExponent, {1}}}}),
              UnorderedElementsAre(Names("grid.rho", "needs at least one"),
                                   Names("grid.epsilon", "does not use this list"),
                                   Names("grid.exponent", "does not use this list")));
}

TEST(EnsembleSpec, TargetsInTheWrongUnitAreRejected) {
  EnsembleSpec spec = ValidFirstHit();
  spec.target = {.collisions = 10};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.collisions", "use target.samples")));
  spec.target = {.samples = kMaxSamples + 1};
  EXPECT_THAT(Violations(spec),
              ElementsAre(Names("target.samples", "permitted: 1 to 1000000000000")));
  spec.grid[kEpsilon] = {0.5};
  for (const double tolerance : {0.0, -0.1, 1.0, std::nan(""), HUGE_VAL}) {
    spec.target = {.tolerance = tolerance};
    EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "0 < tolerance < 1")));
  }
}

// The replicas of this gas are cut short, so that a replica has hardly any collisions.
EnsembleSpec RareCollisions(int64_t collisions) {
  return SpecOf(&kGasConduction,
                {{kRho, 0.53}, {kDelta, 1e-10}, {kCells, 2}, {kHot, 1.5}, {kCold, 0.5}},
                {.collisions = collisions}, Model::kBilliard);
}

// The number of samples would not fit an integer.
TEST(EnsembleSpec, CollisionsThatNeedTooManySamplesAreRejected) {
  EXPECT_THAT(Violations(RareCollisions(1'000'000)),
              ElementsAre(Names("target.collisions", "is 1000000, but a sample has")));
  EnsembleSpec spec = RareCollisions(kMaxSamples);
  spec.grid[kDelta] = {0.1, 1e-6};
  const std::vector<FieldViolation> found = Violations(spec);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "target.collisions");
  const size_t permitted = found[0].description.find("permitted: 1 to ");
  ASSERT_NE(permitted, std::string::npos) << found[0].description;
  spec.target.collisions = std::stoll(found[0].description.substr(permitted + 16));
  EXPECT_THAT(Violations(spec), IsEmpty());
  EXPECT_LE(SamplesAskedFor(spec, PointAt(spec, 1)), static_cast<uint64_t>(kMaxSamples));
  ++*spec.target.collisions;
  EXPECT_EQ(Violations(spec).size(), 1u);
}

TEST(EnsembleSpec, TheNumberOfSamplesHasALimitForEveryTarget) {
  const EnsembleSpec spec = RareCollisions(kMaxSamples);
  EXPECT_EQ(SamplesAskedFor(spec, PointAt(spec, 0)), static_cast<uint64_t>(kMaxSamples));
}

TEST(EnsembleSpec, TheTemperatureOfAGasIsOneByDefault) {
  EnsembleSpec spec = SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.1));
  spec.grid[kTemperature] = {1};
  const PointParameters given = PointAt(spec, 0);
  spec.grid[kTemperature] = {};
  EXPECT_THAT(Violations(spec), IsEmpty());
  EXPECT_EQ(PointAt(spec, 0), given);
}

TEST(EnsembleSpec, DeltaWithTimesOutsideTheRangeOfDoubleIsRejected) {
  EnsembleSpec spec = ValidFirstHit();
  spec.grid[kDelta] = {0.1, 1e-36, std::numeric_limits<double>::denorm_min()};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[1]", "is 1e-36, too small"),
                                            Names("grid.delta[2]", "too small")));
  // The smallest radius decides.
  spec.grid[kRho] = {0.6, std::nextafter(0.5, 1)};
  spec.grid[kDelta] = {1e-33};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[0]", "too small")));
  spec = {.experiment = &kEquilibrium, .grid = {{kRho, {0.6}}, {kDelta, {1e-33}}}};
  EXPECT_THAT(Violations(spec), testing::IsEmpty());
}

TEST(EnsembleSpec, UnreachableToleranceIsRejected) {
  EnsembleSpec spec = ValidFirstHit();
  spec.target = {.tolerance = 0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "epsilon = 0")));
}

EnsembleSpec ValidRelaxation() {
  return {.experiment = &kEnergyRelaxation, .grid = {{kRho, {0.55}}, {kDelta, {0.1}}}};
}

TEST(EnsembleSpec, RelaxationTakesAnyNumberOfInitialEnergies) {
  EnsembleSpec spec = ValidRelaxation();
  EXPECT_THAT(Violations(spec), IsEmpty());
  EXPECT_EQ(PointAt(spec, 0), (PointParameters{{kRho, 0.55}, {kDelta, 0.1}}));
  spec.grid[kEpsilon] = {0, 0.01, 0.5};
  EXPECT_THAT(Violations(spec), IsEmpty());
  EXPECT_EQ(PointAt(spec, 2), (PointParameters{{kRho, 0.55}, {kDelta, 0.1}, {kEpsilon, 0.5}}));
  for (const Target& target : {Target{.samples = 10}, Target{.collisions = 10},
                               Target{.tolerance = 0.1}, Target{.budget_seconds = 1}}) {
    spec.target = target;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
  spec.grid[kEpsilon] = {-0.1, 0.51, std::nan("")};
  EXPECT_THAT(Violations(spec), UnorderedElementsAre(Names("grid.epsilon[0]", "[0, 0.5]"),
                                                     Names("grid.epsilon[1]", "[0, 0.5]"),
                                                     Names("grid.epsilon[2]", "[0, 0.5]")));
  spec.grid = {{kRho, {0.55}}, {kDelta, {0.1}}, {kExponent, {1}}};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.exponent", "does not use this list")));
}

// Around 1/6 the integral of the decay has a zero, and the relaxation time a pole.
TEST(EnsembleSpec, ToleranceWithoutARelaxationTimeIsRejected) {
  EnsembleSpec spec = ValidRelaxation();
  spec.grid[kEpsilon] = {0.12, 0.121, 1.0 / 6, 0.199, 0.2};
  spec.target = {.samples = 100};
  EXPECT_THAT(Violations(spec), IsEmpty());
  spec.target = {.tolerance = 0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.epsilon[1]", "[0, 0.12] or [0.2, 0.5]"),
                                            Names("grid.epsilon[2]", "no relaxation time"),
                                            Names("grid.epsilon[3]", "0.199")));
  // As anything else may.
  EnsembleSpec first_hit = ValidFirstHit();
  first_hit.grid[kEpsilon] = {1.0 / 6};
  EXPECT_THAT(Violations(first_hit), IsEmpty());
}

TEST(EnsembleSpec, MarkovPropertyCountsCollisionsWithoutATolerance) {
  EnsembleSpec spec = {.experiment = &kMarkovProperty,
                       .grid = {{kRho, {0.55}}, {kDelta, {0.1}}},
                       .target = {.collisions = 100}};
  EXPECT_THAT(Violations(spec), IsEmpty());
  spec.target = {.budget_seconds = 3};
  EXPECT_THAT(Violations(spec), IsEmpty());
  spec.target = {.samples = 100};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.samples", "use target.collisions")));
  spec.target = {.tolerance = 0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "tends to 0")));
  spec.target = {};
  spec.grid[kEpsilon] = {0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.epsilon", "does not use this list")));
}

TEST(EnsembleSpec, UnsuitableModelsAreRejectedWithTheSuitableOnes) {
  const EnsembleSpec specs[] = {
      {.experiment = &kEquilibrium, .grid = {{kRho, {0.55}}, {kDelta, {0.1}}}},
      {.experiment = &kConditionalMeanFreeTime,
       .grid = {{kRho, {0.55}}, {kDelta, {0.1}}, {kEpsilon, {0.1}}}},
      ValidFirstHit(),
      ValidRelaxation(),
      {.experiment = &kMarkovProperty, .grid = {{kRho, {0.55}}, {kDelta, {0.1}}}}};
  // Of closed_form, spectrum, markov.
  const std::vector<std::vector<bool>> answered = {{true, false, false},
                                                   {true, false, false},
                                                   {false, false, false},
                                                   {false, true, true},
                                                   {false, false, true}};
  constexpr Model kReduced[] = {Model::kClosedForm, Model::kSpectrum, Model::kMarkov};
  for (size_t i = 0; i < std::size(specs); ++i) {
    EnsembleSpec spec = specs[i];
    for (size_t k = 0; k < std::size(kReduced); ++k) {
      spec.model = kReduced[k];
      if (answered[i][k]) {
        EXPECT_THAT(Violations(spec), IsEmpty()) << spec.experiment->name << Name(spec.model);
      } else {
        EXPECT_THAT(
            Violations(spec),
            ElementsAre(Names("model", "cannot answer " + std::string(spec.experiment->name))));
      }
    }
    for (const Model model : {Model::kAuto, Model::kBilliard, Model::kBilliardReference}) {
      spec.model = model;
      EXPECT_THAT(Violations(spec), IsEmpty());
    }
  }
  EnsembleSpec spec = ValidFirstHit();
  spec.model = Model::kMarkov;
  EXPECT_THAT(Violations(spec),
              ElementsAre(Names("model", "permitted: auto, billiard, billiard_reference")));
}

TEST(EnsembleSpec, SinglePrecisionIsOnlyForTheLanes) {
  EnsembleSpec spec = ValidRelaxation();
  spec.precision = Precision::kSingle;
  for (const Model model : {Model::kAuto, Model::kBilliard}) {
    spec.model = model;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
  for (const Model model : {Model::kSpectrum, Model::kMarkov, Model::kBilliardReference}) {
    spec.model = model;
    EXPECT_THAT(Violations(spec), ElementsAre(Names("precision", Name(model).data())));
  }
}

// A question of each experiment at one corner of the billiard's domain or beyond it.
EnsembleSpec NearTheCorner(const ExperimentKind* experiment, double rho, double delta) {
  EnsembleSpec spec = {.experiment = experiment, .grid = {{kRho, {rho}}, {kDelta, {delta}}}};
  if (experiment == &kConditionalMeanFreeTime || experiment == &kFirstHit) {
    spec.grid[kEpsilon] = {0.1};
  }
  if (experiment == &kFirstHit) spec.grid[kExponent] = {1};
  if (IsOfAGas(experiment)) spec.grid[kCells] = {2};
  if (experiment == &kGasConduction) {
    spec.grid[kHot] = {2};
    spec.grid[kCold] = {1};
  }
  if (experiment == &kGasEquilibrium) spec.grid[kTemperature] = {1};
  return spec;
}

// Beyond this domain rounding makes the billiard wrong (billiard/billiard_domain.h).
TEST(EnsembleSpec, BilliardIsRejectedOutsideItsDomain) {
  const double inside = kMaxRho - 1.1e-9, outside = kMaxRho - 0.9e-9;
  for (const ExperimentKind* experiment : kAllExperiments) {
    for (const Model model : {Model::kBilliard, Model::kBilliardReference}) {
      EnsembleSpec spec = NearTheCorner(experiment, inside, 1.01e-10);
      spec.model = model;
      EXPECT_THAT(Violations(spec), IsEmpty()) << experiment->name;
      spec.grid[kRho] = {inside, outside};
      spec.grid[kDelta] = {0.99e-10, 1.01e-10};
      EXPECT_THAT(Violations(spec),
                  ElementsAre(Names("grid.rho[1]", "billiard_reference: 0.5 < rho <= 0.7071067801"),
                              Names("grid.delta[0]", "billiard_reference: delta >= 1e-10")))
          << experiment->name;
    }
    for (const Model model : {Model::kClosedForm, Model::kSpectrum, Model::kMarkov}) {
      EnsembleSpec spec = NearTheCorner(experiment, outside, 0.99e-10);
      spec.model = model;
      if (!experiment->IsAnsweredBy(model)) continue;
      EXPECT_THAT(Violations(spec), IsEmpty()) << experiment->name;
    }
  }
  EnsembleSpec spec = NearTheCorner(&kMarkovProperty, 0.6, 1e-12);
  spec.model = Model::kBilliard;
  EXPECT_THAT(Violations(spec), ElementsAre(Names("grid.delta[0]", "markov-property: markov")));
  spec = NearTheCorner(&kFirstHit, 0.6, 1e-12);
  EXPECT_THAT(Violations(spec),
              ElementsAre(Names("grid.delta[0]", "no other model answers first-hit")));
}

// AUTO answers by another model where one answers, and is rejected elsewhere.
TEST(EnsembleSpec, AutoNeedsAnotherModelOutsideTheBilliardsDomain) {
  const auto of = [](const ExperimentKind* experiment, const Target& target = {}) {
    EnsembleSpec spec = NearTheCorner(experiment, 0.6, 1e-12);
    spec.target = target;
    return spec;
  };
  const auto is_rejected = ElementsAre(Names("grid.delta[0]", "delta >= 1e-10"));
  EXPECT_THAT(Violations(of(&kEquilibrium)), IsEmpty());
  EnsembleSpec verified = of(&kEquilibrium);
  verified.verify = true;
  EXPECT_THAT(Violations(verified), is_rejected);
  EXPECT_THAT(Violations(of(&kFirstHit)), is_rejected);
  EXPECT_THAT(Violations(of(&kMarkovProperty)), is_rejected);
  EXPECT_THAT(Violations(of(&kEnergyRelaxation)), is_rejected);  // no tolerance: an exact model
  EXPECT_THAT(Violations(of(&kEnergyRelaxation, {.tolerance = 0.01})), IsEmpty());
  EXPECT_THAT(Violations(of(&kEnergyRelaxation, {.budget_seconds = 1})), IsEmpty());
  // Near the mean energy there is no relaxation time, and the limit's error is not known.
  EnsembleSpec spec = of(&kEnergyRelaxation, {.budget_seconds = 1});
  spec.grid[kEpsilon] = {0.1, 1.0 / 6};
  EXPECT_THAT(Violations(spec), is_rejected);
  spec = of(&kEnergyRelaxation);
  spec.grid[kDelta] = {1e-12, 0.01};
  EXPECT_THAT(Violations(spec), is_rejected);
}

// Outside of this domain the errors of single precision are unknown (billiard/single_precision.h).
TEST(EnsembleSpec, SinglePrecisionIsRejectedOutsideItsMeasuredDomain) {
  for (const ExperimentKind* experiment : kAllExperiments) {
    if (IsOfAGas(experiment)) continue;  // it has no single precision
    EnsembleSpec spec = {.experiment = experiment, .precision = Precision::kSingle};
    if (experiment == &kConditionalMeanFreeTime || experiment == &kFirstHit) {
      spec.grid[kEpsilon] = {0.1};
    }
    if (experiment == &kFirstHit) spec.grid[kExponent] = {1};
    spec.grid[kRho] = {0.5 + 0.9e-9, 0.5 + 1.1e-9, kMaxRho - 1.1e-3, kMaxRho - 0.9e-3};
    spec.grid[kDelta] = {0.9e-3, 1e-3};
    EXPECT_THAT(Violations(spec),
                UnorderedElementsAre(Names("grid.rho[0]", "permitted with precision single: 0.5"),
                                     Names("grid.rho[3]", "rho <= 0.7061"),
                                     Names("grid.delta[0]", "single: delta >= 0.001")));
    spec.precision = Precision::kDouble;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
}

TEST(EnsembleSpec, BudgetIsPermittedAloneOrWithATolerance) {
  EnsembleSpec spec = ValidRelaxation();
  for (const double seconds : {1e-3, 1.0, kMaxBudgetSeconds}) {
    spec.target = {.budget_seconds = seconds};
    EXPECT_THAT(Violations(spec), IsEmpty());
    spec.target.tolerance = 0.01;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
  for (const double seconds : {0.0, -1.0, 1.1 * kMaxBudgetSeconds, std::nan(""), HUGE_VAL}) {
    spec.target = {.budget_seconds = seconds};
    EXPECT_THAT(Violations(spec), ElementsAre(Names("target.budget", "0 < budget <= 1")));
  }
  spec.target = {.samples = 10, .budget_seconds = 1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.budget", "alone, or with a tolerance")));
  spec.target = {.collisions = 10, .budget_seconds = 1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.budget", "alone, or with a tolerance")));
  spec.target = {.samples = 10, .tolerance = 0.1};
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target", "more than one kind")));
}

TEST(EnsembleSpec, VerifyIsPermittedOnlyWithAuto) {
  EnsembleSpec spec = {.experiment = &kEquilibrium, .grid = {{kRho, {0.55}}, {kDelta, {0.1}}}};
  spec.verify = true;
  EXPECT_THAT(Violations(spec), IsEmpty());
  for (const Model model : {Model::kClosedForm, Model::kBilliard, Model::kBilliardReference}) {
    spec.model = model;
    EXPECT_THAT(Violations(spec), ElementsAre(Names("verify", "permitted with model auto")));
  }
}

// The closed form needs no variance.
TEST(EnsembleSpec, ToleranceAtARestingPistonRequiresTheClosedForm) {
  EnsembleSpec spec = {.experiment = &kConditionalMeanFreeTime,
                       .grid = {{kRho, {0.55}}, {kDelta, {0.1}}, {kEpsilon, {0, 0.1}}},
                       .target = {.tolerance = 0.1}};
  for (const Model model : {Model::kAuto, Model::kClosedForm}) {
    spec.model = model;
    EXPECT_THAT(Violations(spec), IsEmpty());
  }
  spec.model = Model::kBilliard;
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "epsilon = 0")));
  spec.model = Model::kAuto;
  spec.verify = true;
  EXPECT_THAT(Violations(spec), ElementsAre(Names("target.tolerance", "epsilon = 0")));
  // Relaxation from rest ends with the window.
  EnsembleSpec relaxation = ValidRelaxation();
  relaxation.grid[kEpsilon] = {0};
  relaxation.target = {.tolerance = 0.1};
  EXPECT_THAT(Violations(relaxation), IsEmpty());
}

EnsembleSpec ValidGas() {
  return {.experiment = &kGasEquilibrium,
          .grid = {{kRho, {0.55}}, {kDelta, {0.1}}, {kCells, {4}}, {kTemperature, {1}}}};
}

TEST(EnsembleSpec, EachExperimentPermitsTheNamesOfItsAims) {
  for (const ExperimentKind* experiment : kAllExperiments) {
    EXPECT_EQ(experiment->FindAim(""), &experiment->aims.front());
    for (const AimedEstimate& aim : experiment->aims) {
      EXPECT_EQ(experiment->FindAim(aim.name), &aim);
      for (const Model model : aim.models) EXPECT_TRUE(experiment->IsAnsweredBy(model));
    }
  }
  EnsembleSpec spec = ValidGas();
  for (const char* name : {"", "exchange_rate", "conductivity"}) {
    spec.target.estimate = name;
    EXPECT_THAT(Violations(spec), IsEmpty()) << name;
  }
}

TEST(EnsembleSpec, AnUnknownEstimateIsRejectedWithTheKnownNames) {
  EnsembleSpec spec = ValidGas();
  for (const char* name : {"conduct", "Conductivity", "temperature_ball"}) {
    spec.target.estimate = name;
    EXPECT_THAT(Violations(spec),
                ElementsAre(Names("target.estimate", std::string("is ") + name +
                                                         "; permitted with gas-equilibrium: "
                                                         "exchange_rate, conductivity")));
  }
  // Beside a tolerance that some experiments check point by point.
  for (EnsembleSpec other : {ValidFirstHit(), ValidRelaxation()}) {
    other.target = {.tolerance = 2, .estimate = "conductivity"};
    EXPECT_THAT(Violations(other),
                UnorderedElementsAre(Names("target.estimate", std::string(other.experiment->name)),
                                     Names("target.tolerance", "is 2")));
  }
}

TEST(EnsembleSpec, AnEstimateThatTheModelCannotAnswerIsRejected) {
  EnsembleSpec spec = ValidGas();
  spec.target.estimate = "conductivity";
  spec.model = Model::kClosedForm;
  EXPECT_THAT(Violations(spec),
              ElementsAre(Names("target.estimate",
                                "is conductivity, which model closed_form cannot answer; "
                                "permitted: exchange_rate, or model auto, spectrum, markov, "
                                "billiard, billiard_reference")));
  for (const Model model : {Model::kAuto, Model::kSpectrum, Model::kMarkov, Model::kBilliard,
                            Model::kBilliardReference}) {
    spec.model = model;
    EXPECT_THAT(Violations(spec), IsEmpty()) << Name(model);
  }
  // A model that answers no estimate of the experiment is one violation.
  EnsembleSpec first_hit = ValidFirstHit();
  first_hit.target.estimate = "mean_hit_time";
  first_hit.model = Model::kMarkov;
  EXPECT_THAT(Violations(first_hit), ElementsAre(Names("model", "cannot answer first-hit")));
}

TEST(EnsembleSpec, TheEstimateDecidesWhetherTheClosedFormAnswers) {
  EnsembleSpec spec = ValidGas();
  EXPECT_TRUE(IsAnsweredByClosedForm(spec));
  spec.target.estimate = "exchange_rate";
  EXPECT_TRUE(NeedsNoSamples(spec));
  spec.target.estimate = "conductivity";
  EXPECT_FALSE(IsAnsweredByClosedForm(spec));
  EXPECT_FALSE(NeedsNoSamples(spec));
  EXPECT_EQ(OnePointSpec(spec, PointAt(spec, 0), Model::kMarkov).target.estimate, "conductivity");
}

TEST(EnsembleSpec, NamesAreAsUsersWriteThem) {
  EXPECT_EQ(kEnergyRelaxation.name, "energy-relaxation");
  EXPECT_EQ(kMarkovProperty.name, "markov-property");
  EXPECT_EQ(Name(Model::kSpectrum), "spectrum");
  EXPECT_EQ(Name(Model::kMarkov), "markov");
}

TEST(EnsembleSpec, MissingExperimentIsNamed) {
  EXPECT_THAT(Violations({}), Contains(Names("experiment", "energy-relaxation, markov-property")));
}

}  // namespace
}  // namespace ballpiston
