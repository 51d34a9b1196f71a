#include "core/model_choice/ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/billiard/single_precision.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/expected_limit_error.h"
#include "tests/core/model_choice/questions.h"

namespace ballpiston {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Target kTargets[] = {{}, {.tolerance = 1e-6}, {.tolerance = 0.1}, {.budget_seconds = 1}};

TEST(Ladder, AutoChoosesTheClosedFormIfThereIsOne) {
  for (const ExperimentKind* experiment : {&kEquilibrium, &kConditionalMeanFreeTime}) {
    for (const Target& target : kTargets) {
      const std::optional<Answer> answer = Choice(Asked(experiment, 0.1, target), MayNotBeAsked);
      EXPECT_EQ(answer->model, Model::kClosedForm);
      EXPECT_EQ(answer->model_error, 0);
      EXPECT_THAT(answer->reason, HasSubstr("exact"));
    }
  }
}

TEST(Ladder, VerifyChoosesTheBilliardDespiteAClosedForm) {
  for (const ExperimentKind* experiment : {&kEquilibrium, &kConditionalMeanFreeTime}) {
    EnsembleSpec spec = Asked(experiment, 0.1);
    spec.verify = true;
    const std::optional<Answer> answer = Choice(spec, MayNotBeAsked);
    EXPECT_EQ(answer->model, Model::kBilliard);
    EXPECT_THAT(answer->reason, HasSubstr("verify"));
  }
}

// Only the billiard measures laws: neither a tolerance nor a budget makes another model answer.
TEST(Ladder, AutoChoosesTheBilliardIfNoCheaperModelAnswers) {
  for (const ExperimentKind* experiment : {&kFirstHit, &kMarkovProperty}) {
    for (const Target& target : kTargets) {
      if (experiment == &kMarkovProperty && target.tolerance) continue;
      const std::optional<Answer> answer = Choice(Asked(experiment, 0.1, target), MayNotBeAsked);
      EXPECT_EQ(answer->model, Model::kBilliard);
      EXPECT_EQ(answer->model_error, 0);
    }
  }
}

TEST(Ladder, WithoutAToleranceRelaxationUsesTheBilliard) {
  for (const double delta : {0.3, 1e-4}) {
    for (const Target& target : {Target{}, Target{.samples = 10}, Target{.collisions = 10}}) {
      EXPECT_EQ(Choice(Relaxation(delta, target), MayNotBeAsked)->model, Model::kBilliard);
    }
  }
}

// Beyond the billiard's domain the limit answers without a pilot.
TEST(Ladder, TheLimitAnswersWhereTheBilliardIsNotSound) {
  for (const Target& target : {Target{.tolerance = 0.01}, Target{.budget_seconds = 1}}) {
    const EnsembleSpec spec = Relaxation(1e-12, target);
    ASSERT_TRUE(Violations(spec).empty());
    const Answer answer = *Choice(spec, MayNotBeAsked);
    EXPECT_EQ(answer.model, Model::kSpectrum);
    EXPECT_GT(*answer.model_error, 0);
    EXPECT_THAT(answer.reason, HasSubstr("not sound at this rho and delta"));
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked);
    for (const Rung& rung : ladder.rungs) {
      EXPECT_EQ(rung.answers, IsOfTheLimit(rung.model)) << Name(rung.model);
    }
  }
}

// Deltas and tolerances over five decades each: a pilot is used at most once, at the point's place,
// and then its result decides.
TEST(Ladder, APilotRunsOnlyIfItCanDecide) {
  int asked = 0, told_without = 0;
  for (double delta = 0.3; delta > 1e-5; delta /= 2) {
    for (double tolerance = 0.5; tolerance > 1e-6; tolerance /= 2) {
      const EnsembleSpec spec = Relaxation(delta, {.tolerance = tolerance});
      const PointParameters point = PointAt(spec, 0);
      const PilotPlace place = PilotPlaceFor(point);
      const double error_of_pilot = PredictedPilot(place).standard_error;
      // Pilots that leave the limit just within the tolerance, and just beyond.
      for (const double share : {0.999, 1.001}) {
        const double there = share * tolerance * place.delta / delta;
        const Pilot pilot = {.difference = std::max(there - 2 * error_of_pilot, 0.0),
                             .standard_error = error_of_pilot};
        MadeUpPilots pilots(pilot);
        const Answer answer = *Choice(spec, pilots.source());
        if (pilots.asked().empty()) {
          EXPECT_EQ(answer.model, Model::kBilliard) << delta << " to " << tolerance;
          ++told_without;
          continue;
        }
        ++asked;
        ASSERT_EQ(pilots.asked().size(), 1u);
        EXPECT_EQ(pilots.asked()[0], place);
        EXPECT_EQ(answer.model, share < 1 ? Model::kSpectrum : Model::kBilliard);
        EXPECT_EQ(answer.model_error, share < 1 ? LimitErrorBound(pilot, place, point) : 0);
        EXPECT_LE(*answer.model_error, tolerance);
        EXPECT_THAT(answer.reason, HasSubstr("pilot at delta"));
      }
    }
  }
  EXPECT_GT(asked, 100);
  EXPECT_GT(told_without, 100);
}

// The three reasons for using no pilot.
TEST(Ladder, TheReasonForRunningNoPilotIsStated) {
  // The limit is 5 % off at delta = 0.2.
  EXPECT_THAT(Choice(Relaxation(0.2, {.tolerance = 0.01}), MayNotBeAsked)->reason,
              HasSubstr("beyond the tolerance"));
  // Two errors of a pilot are 1 % at its place, and 1e-3 at a tenth of its delta.
  EXPECT_THAT(Choice(Relaxation(0.0097, {.tolerance = 0.0007}), MayNotBeAsked)->reason,
              HasSubstr("could not establish"));
  EXPECT_THAT(Choice(Relaxation(0.09, {.tolerance = 0.05}), MayNotBeAsked)->reason,
              HasSubstr("before a pilot"));
}

// The discs nearly touch: a collision takes 1e9 times as many wall hits as in the paper's cell.
TEST(Ladder, APilotOfYearsIsSkipped) {
  EnsembleSpec spec = Relaxation(7e-9, {.tolerance = 0.1});
  spec.grid[kRho] = {0.50000378};
  spec.grid[kEpsilon] = {0};
  const Answer answer = *Choice(spec, MayNotBeAsked);
  EXPECT_EQ(answer.model, Model::kSpectrum);
  EXPECT_THAT(answer.reason, HasSubstr("is within the tolerance"));
}

TEST(Ladder, OnePilotServesAllSmallerDeltas) {
  const Pilot pilot = {.difference = 0.01, .standard_error = 0.005};
  std::optional<PilotPlace> place;
  for (const double delta : {0.03, 0.01, 0.001}) {
    MadeUpPilots pilots(pilot);
    const EnsembleSpec spec = Relaxation(delta, {.tolerance = 0.01});
    const Answer answer = *Choice(spec, pilots.source());
    ASSERT_EQ(pilots.asked().size(), 1u) << delta;
    if (place) {
      EXPECT_EQ(*place, pilots.asked()[0]);
    }
    place = pilots.asked()[0];
    EXPECT_EQ(answer.model, Model::kSpectrum);
    EXPECT_NEAR(*answer.model_error, 0.02 * delta / place->delta, 1e-15);
  }
}

// From an energy far from both ends the error scales as in equilibrium. For a resting piston the
// limit does not apply at any delta.
TEST(Ladder, APilotServesADecayToo) {
  MadeUpPilots pilots(Pilot{.difference = 0.01, .standard_error = 0.01});
  EnsembleSpec spec = Relaxation(0.0125, {.tolerance = 0.02});
  spec.grid[kEpsilon] = {0.4};
  EXPECT_EQ(Choice(spec, pilots.source())->model, Model::kSpectrum);
  ASSERT_EQ(pilots.asked().size(), 1u);
  EXPECT_GT(pilots.asked()[0].delta, 0.0125);
  EXPECT_EQ(pilots.asked()[0].epsilon, 0.4);
  spec.grid[kEpsilon] = {1e-6};
  EXPECT_EQ(Choice(spec, pilots.source())->model, Model::kBilliard);
  EXPECT_EQ(pilots.asked().size(), 1u);
}

TEST(Ladder, WithoutThePilotsResultThereIsNoAnswer) {
  MadeUpPilots stopped(std::nullopt);
  EXPECT_FALSE(Choice(Relaxation(0.01, {.tolerance = 0.01}), stopped.source()));
  EXPECT_EQ(stopped.asked().size(), 1u);
}

TEST(Ladder, WithAToleranceEveryMachineMakesTheSameChoice) {
  const Pilot pilot = {.difference = 0.01, .standard_error = 0.005};
  for (double delta = 0.3; delta > 1e-4; delta /= 1.7) {
    for (double tolerance = 0.5; tolerance > 1e-5; tolerance /= 3) {
      const EnsembleSpec spec = Relaxation(delta, {.tolerance = tolerance});
      MadeUpPilots here(pilot), there(pilot);
      const Answer one = *Choice(spec, here.source());
      const Answer other = *Choice(spec, there.source(), SlowerMachine());
      EXPECT_EQ(one.model, other.model);
      EXPECT_EQ(one.reason, other.reason);
      EXPECT_EQ(one.model_error, other.model_error);
      EXPECT_EQ(here.asked(), there.asked());
    }
  }
}

// With a budget alone AUTO chooses the model with the smallest error within the budget.
TEST(Ladder, BudgetChoosesTheBilliardIfItsErrorIsSmaller) {
  double turn = 0;
  for (double seconds = 1e-3; seconds < 1e5; seconds *= 2) {
    const Answer answer = *Choice(Relaxation(0.0125, {.budget_seconds = seconds}), MayNotBeAsked);
    if (turn == 0 && answer.model == Model::kBilliard) turn = seconds;
    EXPECT_EQ(answer.model, turn == 0 ? Model::kSpectrum : Model::kBilliard) << seconds;
    EXPECT_EQ(*answer.model_error, turn == 0 ? ExpectedLimitError(PaperPoint(0.0125)) : 0);
  }
  EXPECT_GT(turn, 1);
  EXPECT_LT(turn, 1e4);
  EXPECT_EQ(Choice(Relaxation(0.3, {.budget_seconds = 1}), MayNotBeAsked)->model, Model::kBilliard);
}

TEST(Ladder, BudgetIsSharedByWorkersAndPoints) {
  EnsembleSpec spec = Relaxation(0.1, {.budget_seconds = 6});
  EXPECT_EQ(BudgetOfAPoint(spec, 4), 24);
  spec.grid[kDelta] = {0.1, 0.2, 0.3};
  EXPECT_EQ(BudgetOfAPoint(spec, 4), 8);
}

// The point ends with the tolerance or the budget, whichever is reached first.
TEST(Ladder, BudgetWithToleranceChoosesTheBilliardIfItReachesTheTolerance) {
  const auto choice = [](double tolerance, double seconds) {
    const Target target = {.tolerance = tolerance, .budget_seconds = seconds};
    return Choice(Relaxation(0.0125, target), MayNotBeAsked)->model;
  };
  const double limit = ExpectedLimitError(PaperPoint(0.0125));
  EXPECT_EQ(choice(0.5, 1), Model::kBilliard);
  EXPECT_EQ(choice(1.01 * limit, 1), Model::kSpectrum);
  EXPECT_EQ(choice(0.99 * limit, 1), Model::kBilliard);  // the limit is beyond the tolerance
  EXPECT_EQ(choice(1e-5, 1e5), Model::kBilliard);
}

// Near 1/sqrt 2 the limit's error is large, and the billiard is not sound.
TEST(Ladder, ABudgetDoesNotLetTheLimitMissATolerance) {
  for (const std::optional<double> tolerance : {std::optional<double>(), {0.9}, {0.01}}) {
    EnsembleSpec spec = Relaxation(1.2e-10, {.tolerance = tolerance, .budget_seconds = 1});
    spec.grid[kRho] = {kMaxRho - 1e-10};
    EXPECT_EQ(Violations(spec).empty(), tolerance != 0.01);
  }
}

// A plan and its result have an error from the same number of samples on.
TEST(Ladder, SamplesBelowThoseOfAnErrorHaveNoPlannedError) {
  for (const int64_t collisions : {499, 500}) {
    EnsembleSpec spec = Asked(&kEquilibrium, 0.1, {.collisions = collisions});
    spec.model = Model::kBilliard;
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked);
    EXPECT_EQ(ladder.Chosen().statistical_error.has_value(), collisions == 500);
  }
}

// Without a relaxation time the limit's error is unknown.
TEST(Ladder, AroundTheMeanEnergyRelaxationUsesTheBilliard) {
  for (const Target& target : {Target{}, Target{.budget_seconds = 1e-3}}) {
    EnsembleSpec spec = Relaxation(0.01, target);
    spec.grid[kEpsilon] = {0.15};
    EXPECT_EQ(Choice(spec, MayNotBeAsked)->model, Model::kBilliard);
    MadeUpPilots none(std::nullopt);
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), none.source());
    EXPECT_FALSE(ladder.rungs[1].model_error);
    EXPECT_FALSE(ladder.Chosen().statistical_error);
    EXPECT_TRUE(none.asked().empty());
  }
}

// The result of a pilot that has not run is predicted, and its cost is part of the answer's work,
// unless another point of the grid runs the pilot.
TEST(Ladder, AnUnknownPilotIsPartOfTheWork) {
  const EnsembleSpec spec = Relaxation(0.001, {.tolerance = 0.01});
  MadeUpPilots none(std::nullopt);
  Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), none.source());
  EXPECT_EQ(ladder.answer.model, Model::kSpectrum);
  EXPECT_EQ(ladder.pilot, PilotPlaceFor(PointAt(spec, 0)));
  EXPECT_EQ(ladder.work_of_pilot, SecondsOfPilot(*ladder.pilot, SomeMachine().rates));
  EXPECT_GT(ladder.work_of_pilot, 0.1);
  EXPECT_DOUBLE_EQ(*ladder.Chosen().work, SomeMachine().rates.spectrum + ladder.work_of_pilot);
  EXPECT_DOUBLE_EQ(ladder.Chosen().time, *ladder.Chosen().work);
  EXPECT_THAT(ladder.Chosen().reason, HasSubstr("with the pilot"));
  ladder.DropPilot();
  EXPECT_NEAR(*ladder.Chosen().work, SomeMachine().rates.spectrum, 1e-12);
  EXPECT_NEAR(ladder.Chosen().time, SomeMachine().rates.spectrum, 1e-12);
  EXPECT_THAT(ladder.Chosen().reason, Not(HasSubstr("with the pilot")));
  EXPECT_FALSE(ladder.pilot);
  ladder.DropPilot();  // no more than once
  EXPECT_NEAR(*ladder.Chosen().work, SomeMachine().rates.spectrum, 1e-12);
}

// No pilot checks the bound for a gas, so the bound alone decides.
TEST(Ladder, TheJumpProcessAnswersWhereItsBoundIsWithinHalfOfTheTolerance) {
  for (double delta = 0.2; delta > 1e-3; delta /= 2) {
    const double bound = ExpectedLimitErrorOfConduction(PaperGas(&kGasConduction, delta));
    for (const double share : {0.999, 1.001}) {
      const EnsembleSpec spec = Asked(&kGasConduction, delta, {.tolerance = 2 * bound / share});
      const Answer answer = *Choice(spec, MayNotBeAsked);
      EXPECT_EQ(answer.model, share < 1 ? Model::kMarkov : Model::kBilliard) << delta;
      EXPECT_EQ(answer.model_error, share < 1 ? bound : 0) << delta;
      EXPECT_THAT(answer.reason, HasSubstr(share < 1 ? "within half" : "beyond half"));
    }
    for (const Target& target : {Target{}, Target{.samples = 10}, Target{.collisions = 10}}) {
      EXPECT_EQ(Choice(Asked(&kGasConduction, delta, target), MayNotBeAsked)->model,
                Model::kBilliard);
    }
  }
}

EnsembleSpec Conductivity(double delta, Target target = {}) {
  target.estimate = "conductivity";
  return Asked(&kGasEquilibrium, delta, target);
}

double BoundOfConductivity(const EnsembleSpec& spec) {
  return kGasEquilibrium.FindAim("conductivity")->limit_error->expected(PointAt(spec, 0));
}

// The bound of the limit, that of the gas's size, and the error of the spectrum's value. One cell
// has no correlations at all, and another exchange rate. In a lattice few rows count too.
TEST(Ladder, TheBoundOfTheConductivityCountsTheSizeOfTheGas) {
  EnsembleSpec spec = Conductivity(0.01);
  spec.grid[kCells] = {CodeOf({.columns = 8})};
  const double of_limit = 1.5 * ExpectedLimitError(PaperPoint(0.01));
  EXPECT_NEAR(BoundOfConductivity(spec), of_limit + 1.04e-5, 1e-8);
  spec.grid[kCells] = {CodeOf({.columns = 2})};
  EXPECT_NEAR(BoundOfConductivity(spec), of_limit + 5e-4, 1e-6);
  spec = Conductivity(0.2);
  spec.grid[kCells] = {CodeOf({.columns = 1})};
  EXPECT_NEAR(BoundOfConductivity(spec),
              1.5 * ExpectedLimitError(PaperPoint(0.2)) + 0.0018 + 0.0119, 1e-4);
  spec = Conductivity(1e-6);
  for (const auto& [rows, error] : {std::pair(1, 2.7e-4), std::pair(2, 5e-5), std::pair(8, 2e-5)}) {
    spec.grid[kCells] = {CodeOf({.columns = 8, .rows = rows, .is_lattice = true})};
    EXPECT_NEAR(BoundOfConductivity(spec), error, 1e-6) << rows;
  }
}

// In one column the conductivity has no scatter but rounding, which never reaches this tolerance.
TEST(Ladder, AToleranceBelowRoundingTakesAllSamplesInOneColumn) {
  EnsembleSpec spec = Conductivity(0.03, {.tolerance = 1e-200});
  spec.model = Model::kMarkov;
  spec.grid[kCells] = {CodeOf({.columns = 1})};
  const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked);
  EXPECT_EQ(ladder.Chosen().samples, kMaxSamples);
}

// The cold wall's slow pistons: more of them at a lower temperature, at a larger delta, and in a
// short chain.
TEST(Ladder, TheBoundOfTheHeatCurrentGrowsTowardsAColdReservoir) {
  const auto bound = [](double delta, int64_t columns, double cold) {
    PointParameters point = PaperGas(&kGasConduction, delta, {.columns = columns});
    point.Set(kHot, 1);
    point.Set(kCold, cold);
    return ExpectedLimitErrorOfConduction(point);
  };
  EXPECT_EQ(bound(0.1, 1, 1), ExpectedLimitErrorInAGas(PaperPoint(0.1)));
  EXPECT_GT(bound(0.1, 1, 0.01), 0.097);  // the measured difference
  EXPECT_GT(bound(0.1, 1, 1e-6), 0.885);  // likewise
  EXPECT_LE(bound(0.2, 1, 1e-300), 1);
  EXPECT_GT(bound(0.1, 1, 1e-3), bound(0.1, 3, 1e-3));
  EXPECT_GT(bound(0.1, 3, 1e-3), bound(0.05, 3, 1e-3));
  // In proportion to x = stroke times rate, which falls as delta^2.
  EXPECT_NEAR(bound(1e-5, 1, 1e-4) / bound(1e-6, 1, 1e-4), 100, 5);
}

// The question of 0.12 that the jump process answered nine times too large.
TEST(Ladder, TheBilliardAnswersNextToAVeryColdReservoir) {
  EnsembleSpec spec = Asked(&kGasConduction, 0.1, {.tolerance = 0.12});
  spec.grid[kHot] = {1};
  spec.grid[kCold] = {1e-6};
  EXPECT_EQ(Choice(spec, MayNotBeAsked)->model, Model::kBilliard);
}

TEST(Ladder, TheSpectrumAnswersTheConductivityWhereItsBoundIsWithinTheTolerance) {
  EXPECT_EQ(Choice(Conductivity(0.01, {.tolerance = 0.05}), MayNotBeAsked)->model,
            Model::kSpectrum);
  EXPECT_EQ(Choice(Conductivity(0.2, {.tolerance = 0.05}), MayNotBeAsked)->model, Model::kBilliard);
  for (double delta = 0.2; delta > 1e-3; delta /= 2) {
    const double bound = BoundOfConductivity(Conductivity(delta));
    for (const double share : {0.999, 1.001}) {
      const EnsembleSpec spec = Conductivity(delta, {.tolerance = bound / share});
      const Answer answer = *Choice(spec, MayNotBeAsked);
      EXPECT_EQ(answer.model, share < 1 ? Model::kSpectrum : Model::kBilliard) << delta;
      EXPECT_EQ(answer.model_error, share < 1 ? bound : 0) << delta;
      EXPECT_THAT(answer.reason,
                  HasSubstr(share < 1 ? "is within the tolerance" : "is beyond the tolerance"));
    }
  }
}

TEST(Ladder, WithoutAToleranceTheConductivityUsesTheBilliard) {
  for (const Target& target : {Target{}, Target{.samples = 10}, Target{.collisions = 10}}) {
    const Answer answer = *Choice(Conductivity(1e-4, target), MayNotBeAsked);
    EXPECT_EQ(answer.model, Model::kBilliard);
    EXPECT_THAT(answer.reason, HasSubstr("without a tolerance"));
  }
  EXPECT_EQ(Choice(Conductivity(1e-4, {.budget_seconds = 1}), MayNotBeAsked)->model,
            Model::kSpectrum);
  EXPECT_EQ(Choice(Conductivity(0.2, {.budget_seconds = 1e6}), MayNotBeAsked)->model,
            Model::kBilliard);
}

TEST(Ladder, ThePlanRefersToTheNamedEstimate) {
  EnsembleSpec spec = Conductivity(0.01, {.tolerance = 0.05});
  const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked);
  EXPECT_FALSE(ladder.rungs[0].answers);
  EXPECT_EQ(ladder.rungs[0].reason, "there is no closed form for conductivity");
  const double bound = BoundOfConductivity(spec);
  for (const size_t i : {1, 2}) EXPECT_EQ(ladder.rungs[i].model_error, bound);
  EXPECT_EQ(ladder.rungs[1].statistical_error, 0);
  const double one = kGasEquilibrium.FindAim("conductivity")->error(spec.model, PointAt(spec, 0));
  const Rung& billiard = ladder.rungs[3];
  EXPECT_EQ(billiard.statistical_error, one / std::sqrt(*billiard.samples));
  // The same question with the default estimate.
  spec.target.estimate = "exchange_rate";
  const Ladder of_rate = LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked);
  EXPECT_EQ(of_rate.answer.model, Model::kClosedForm);
  EXPECT_FALSE(of_rate.rungs[1].model_error);
}

TEST(Ladder, ABudgetWeighsTheStatisticalErrorOfTheJumpProcess) {
  const EnsembleSpec scarce = Asked(&kGasConduction, 0.0125, {.budget_seconds = 1e-3});
  EXPECT_EQ(Choice(scarce, MayNotBeAsked)->model, Model::kMarkov);
  const EnsembleSpec plenty = Asked(&kGasConduction, 0.0125, {.budget_seconds = 1e5});
  EXPECT_EQ(Choice(plenty, MayNotBeAsked)->model, Model::kBilliard);
  const EnsembleSpec near_the_bound = Asked(&kGasConduction, 0.2, {.budget_seconds = 1});
  EXPECT_EQ(Choice(near_the_bound, MayNotBeAsked)->model, Model::kBilliard);
}

TEST(Ladder, ANamedModelAnswersWithAnyError) {
  for (const ExperimentKind* experiment : kAllExperiments) {
    for (const Model model : kLadder) {
      if (!experiment->IsAnsweredBy(model)) continue;
      EnsembleSpec spec = Asked(experiment, 0.2);
      spec.model = model;
      const Answer answer = *Choice(spec, MayNotBeAsked);
      EXPECT_EQ(answer.model, model);
      const bool limit = model == Model::kSpectrum || model == Model::kMarkov;
      if (!limit) {
        EXPECT_EQ(answer.model_error, 0);
      } else if (AimOf(spec).limit_error != nullptr) {
        EXPECT_EQ(answer.model_error, AimOf(spec).limit_error->expected(PointAt(spec, 0)));
      } else {
        EXPECT_FALSE(answer.model_error);  // unknown
      }
    }
  }
}

TEST(Ladder, ListsEveryModelCheapestFirstWithReasons) {
  for (const ExperimentKind* experiment : kAllExperiments) {
    MadeUpPilots none(std::nullopt);
    const EnsembleSpec spec = Asked(experiment, 0.05);
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), none.source());
    ASSERT_EQ(ladder.rungs.size(), std::size(kLadder));
    for (size_t i = 0; i < ladder.rungs.size(); ++i) {
      const Rung& rung = ladder.rungs[i];
      EXPECT_EQ(rung.model, kLadder[i]);
      EXPECT_EQ(rung.answers, experiment->IsAnsweredBy(rung.model));
      EXPECT_FALSE(rung.reason.empty());
      EXPECT_EQ(rung.work.has_value(), rung.answers);
      if (rung.answers) {
        EXPECT_GT(*rung.work, 0);
      }
    }
    EXPECT_TRUE(ladder.Chosen().answers);
    EXPECT_EQ(ladder.Chosen().model, ladder.answer.model);
    EXPECT_EQ(ladder.answer.model, Choice(spec, none.source())->model);
  }
}

TEST(Ladder, SamplesAreThoseThatTheTargetNeeds) {
  const auto rung = [](const EnsembleSpec& spec, Model model) {
    MadeUpPilots none(std::nullopt);
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), none.source());
    return *std::find_if(ladder.rungs.begin(), ladder.rungs.end(),
                         [model](const Rung& r) { return r.model == model; });
  };
  for (const Model model : {Model::kMarkov, Model::kBilliard, Model::kBilliardReference}) {
    EXPECT_EQ(rung(Relaxation(0.1, {.samples = 123}), model).samples, 123);
    EXPECT_EQ(rung(Relaxation(0.1, {.collisions = 4000}), model).samples, 100);  // of 40 each
    EXPECT_EQ(rung(Relaxation(0.1), model).samples, kDefaultSamples);
    const Rung to_tolerance = rung(Relaxation(0.1, {.tolerance = 0.002}), model);
    EXPECT_LE(*to_tolerance.statistical_error, 0.002);
    EXPECT_GT(*to_tolerance.statistical_error, 0.0015);
    const Rung in_time = rung(Relaxation(0.1, {.budget_seconds = 3}), model);
    EXPECT_LE(*in_time.work, 3);
    EXPECT_GT(*in_time.work, 2.9);
    // The tolerance first, if the time allows it.
    const Rung either = rung(Relaxation(0.1, {.tolerance = 0.3, .budget_seconds = 100}), model);
    EXPECT_LT(*either.work, 100);
    EXPECT_EQ(*either.samples, *rung(Relaxation(0.1, {.tolerance = 0.3}), model).samples);
  }
  for (const Model model : {Model::kSpectrum, Model::kClosedForm}) {
    const Rung exact =
        rung(Asked(model == Model::kSpectrum ? &kEnergyRelaxation : &kEquilibrium, 0.1), model);
    EXPECT_EQ(exact.samples, 0);
    EXPECT_EQ(exact.statistical_error, 0);
  }
}

// 200 points of one sample each were planned at 2 ms and took 0.8 s.
TEST(Ladder, AFirstHitsWorkCountsItsSummary) {
  const EnsembleSpec spec = Asked(&kFirstHit, 0.1, {.samples = 1});
  const Ladder ladder =
      LadderFor(spec, PointAt(spec, 0), SomeMachine(), MadeUpPilots(std::nullopt).source());
  EXPECT_GT(*ladder.Chosen().work, 1e-3);
  EXPECT_LT(*ladder.Chosen().work, 5e-3);
}

TEST(Ladder, ModelErrorIsFromAPilotIfOneIsKnown) {
  const EnsembleSpec spec = Relaxation(0.01);
  const PointParameters point = PointAt(spec, 0);
  const Pilot pilot = {.difference = 0.02, .standard_error = 0.005};
  MadeUpPilots none(std::nullopt), known(pilot);
  const Ladder without = LadderFor(spec, point, SomeMachine(), none.source());
  const Ladder with = LadderFor(spec, point, SomeMachine(), known.source());
  for (const size_t i : {1u, 2u}) {
    EXPECT_EQ(without.rungs[i].model_error, ExpectedLimitError(point));
    EXPECT_THAT(without.rungs[i].reason, HasSubstr("expected"));
    EXPECT_EQ(with.rungs[i].model_error, LimitErrorBound(pilot, PilotPlaceFor(point), point));
    EXPECT_THAT(with.rungs[i].reason, HasSubstr("of a pilot at delta"));
  }
}

EnsembleSpec InSinglePrecision(EnsembleSpec spec) {
  spec.precision = Precision::kSingle;
  return spec;
}

// In single precision the billiard is not exact, for every reason of its choice.
TEST(Ladder, SinglePrecisionHasAModelError) {
  EnsembleSpec verified = InSinglePrecision(Asked(&kEquilibrium, 0.1));
  verified.verify = true;
  EnsembleSpec named = InSinglePrecision(Asked(&kFirstHit, 0.1));
  named.model = Model::kBilliard;
  EnsembleSpec beside_the_zone = InSinglePrecision(Relaxation(0.1, {.tolerance = 0.01}));
  beside_the_zone.grid[kEpsilon] = {0.11};
  for (const EnsembleSpec& spec :
       {verified, named, beside_the_zone, InSinglePrecision(Asked(&kFirstHit, 0.1)),
        InSinglePrecision(Relaxation(0.1)), InSinglePrecision(Relaxation(0.2, {.tolerance = 0.01})),
        InSinglePrecision(Relaxation(0.3, {.budget_seconds = 100}))}) {
    const Answer answer = *Choice(spec, MayNotBeAsked);
    EXPECT_EQ(answer.model, Model::kBilliard);
    EXPECT_EQ(answer.model_error, kSinglePrecisionError);
    EXPECT_THAT(answer.reason, Not(HasSubstr("exact")));
    MadeUpPilots none(std::nullopt);
    const Ladder ladder = LadderFor(spec, PointAt(spec, 0), SomeMachine(), none.source());
    const Rung& billiard = ladder.Chosen();
    EXPECT_EQ(billiard.model_error, kSinglePrecisionError);
    EXPECT_THAT(billiard.reason, AllOf(HasSubstr("single"), Not(HasSubstr("exact"))));
    // The reference is always in double precision.
    EXPECT_EQ(ladder.rungs.back().model_error, 0);
    EXPECT_EQ(ladder.rungs.back().reason, "exact");
  }
}

// Distances between laws tend to 0, so their relative error has no meaning.
TEST(Ladder, SinglePrecisionsErrorIsUnknownWithoutARelativeError) {
  const EnsembleSpec spec = InSinglePrecision(Asked(&kMarkovProperty, 0.1));
  const Answer answer = *Choice(spec, MayNotBeAsked);
  EXPECT_FALSE(answer.model_error);
  EXPECT_THAT(answer.reason, Not(HasSubstr("exact")));
}

TEST(Ladder, SinglePrecisionAffectsOnlyTheLanes) {
  const Answer closed = *Choice(InSinglePrecision(Asked(&kEquilibrium, 0.1)), MayNotBeAsked);
  EXPECT_EQ(closed.model, Model::kClosedForm);
  EXPECT_EQ(closed.model_error, 0);
  MadeUpPilots pilots(Pilot{.difference = 0.01, .standard_error = 0.005});
  const Answer spectrum =
      *Choice(InSinglePrecision(Relaxation(0.0125, {.tolerance = 0.01})), pilots.source());
  EXPECT_EQ(spectrum.model, Model::kSpectrum);
  EXPECT_EQ(pilots.asked().size(), 1u);
}

TEST(Ladder, SinglePrecisionRejectsAToleranceBelowItsError) {
  for (const Model model : {Model::kAuto, Model::kBilliard}) {
    for (const ExperimentKind* experiment : {&kEnergyRelaxation, &kFirstHit}) {
      EnsembleSpec spec =
          InSinglePrecision(Asked(experiment, 0.2, {.tolerance = 0.99 * kSinglePrecisionError}));
      spec.model = model;
      const std::vector<FieldViolation> found = ToleranceViolations(spec);
      ASSERT_EQ(found.size(), 1u);
      EXPECT_EQ(found[0].field, "target.tolerance");
      EXPECT_THAT(found[0].description, HasSubstr("or precision double"));
      spec.target.tolerance = 1.01 * kSinglePrecisionError;
      EXPECT_TRUE(ToleranceViolations(spec).empty());
      spec.target.tolerance = 0.99 * kSinglePrecisionError;
      spec.precision = Precision::kDouble;
      EXPECT_TRUE(ToleranceViolations(spec).empty());
    }
  }
}

TEST(Ladder, ReducedModelsRejectAToleranceBelowTheirError) {
  const auto violations = [](const ExperimentKind* experiment, Model model, double tolerance,
                             double delta) {
    EnsembleSpec spec = Asked(experiment, delta, {.tolerance = tolerance});
    spec.model = model;
    return ToleranceViolations(spec);
  };
  for (const Model model : {Model::kSpectrum, Model::kMarkov}) {
    const double error = ExpectedLimitError(PaperPoint(0.2));
    const auto found = violations(&kEnergyRelaxation, model, 0.99 * error, 0.2);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].field, "target.tolerance");
    EXPECT_THAT(found[0].description, HasSubstr("model auto or billiard"));
    EXPECT_TRUE(violations(&kEnergyRelaxation, model, 1.01 * error, 0.2).empty());
    EXPECT_TRUE(violations(&kEnergyRelaxation, model, error / 10, 0.01).empty());
  }
  EXPECT_EQ(violations(&kEquilibrium, Model::kClosedForm, 1e-17, 0.2).size(), 1u);
  EXPECT_TRUE(violations(&kEquilibrium, Model::kClosedForm, 1e-12, 0.2).empty());
  for (const Model model : {Model::kAuto, Model::kBilliard, Model::kBilliardReference}) {
    EXPECT_TRUE(violations(&kEnergyRelaxation, model, 1e-5, 0.2).empty());
    // The largest permitted number of samples limits the tolerance of a model that samples.
    EXPECT_EQ(violations(&kEnergyRelaxation, model, 1e-9, 0.2).size(), 1u);
  }
  // The worst point of the grid counts. Without a tolerance there is no violation.
  EnsembleSpec spec = Relaxation(0.01, {.tolerance = 0.01});
  spec.model = Model::kSpectrum;
  EXPECT_TRUE(ToleranceViolations(spec).empty());
  spec.grid[kDelta] = {0.01, 0.2};
  EXPECT_EQ(ToleranceViolations(spec).size(), 1u);
  spec.target = {};
  EXPECT_TRUE(ToleranceViolations(spec).empty());
}

// ---- what cannot be done ----

EnsembleSpec Conduction(const GasShape& shape, Model model, const Target& target) {
  EnsembleSpec spec = SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.1, shape), target);
  spec.model = model;
  return spec;
}

// A question that needs years is planned. One that needs longer than any machine lasts is rejected.
TEST(Ladder, ALongGasIsPlannedUntilItsTimeIsBeyondAllMachines) {
  const auto asked = [](int64_t columns) {
    EnsembleSpec spec =
        SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.1, {.columns = columns}),
               {.tolerance = 0.05}, Model::kMarkov);
    return std::pair(spec, LadderFor(spec, PointAt(spec, 0), SomeMachine(), MayNotBeAsked));
  };
  const auto [long_gas, ladder] = asked(100'000);
  EXPECT_THAT(ToleranceViolations(long_gas), testing::IsEmpty());
  EXPECT_THAT(TimeViolations(long_gas), testing::IsEmpty());
  EXPECT_GT(ladder.Chosen().time, 1e8);
  EXPECT_LE(*ladder.Chosen().statistical_error, 0.05);
  EXPECT_EQ(TimeViolations(asked(1'000'000).first).size(), 1u);
}

// A chain of 100 had to wait hours for its first chunk, and one of 300 was refused.
TEST(Ladder, ChainsOfHundredsTakeMinutes) {
  for (const auto& [columns, seconds] : {std::pair(100, 1200.), std::pair(300, 3 * 3600.)}) {
    PointParameters point = PaperGas(&kGasConduction, 0.05, {.columns = columns});
    point.Set(kHot, 2);
    point.Set(kCold, 1);
    const EnsembleSpec spec = SpecOf(&kGasConduction, point, {.tolerance = 0.05}, Model::kBilliard);
    EXPECT_LT(LadderFor(spec, point, SomeMachine(), MayNotBeAsked).Chosen().time, seconds);
  }
}

// From epsilon = 1/2 only the orbits meet whose ball starts within the piston's reach.
TEST(Ladder, ATolerancePlansTheSamplesThatAnErrorNeeds) {
  EnsembleSpec spec = Relaxation(0.05, {.tolerance = 0.5});
  spec.model = Model::kBilliard;
  spec.grid[kEpsilon] = {0.5};
  const PointParameters point = PointAt(spec, 0);
  const double needed = AimOf(spec).SamplesForAnError(spec.model, point);
  EXPECT_GT(needed, 1000);
  EXPECT_GE(SamplesFor(0.5, spec, point), needed);
  EXPECT_THAT(ToleranceViolations(spec), testing::IsEmpty());
}

TEST(Ladder, AToleranceWhoseEventsAreTooRareIsRejected) {
  EnsembleSpec spec = Relaxation(1e-8, {.tolerance = 0.5});
  spec.model = Model::kBilliard;
  spec.grid[kEpsilon] = {0.5};
  EXPECT_THAT(ToleranceViolations(spec),
              testing::ElementsAre(testing::Field(
                  &FieldViolation::description,
                  AllOf(HasSubstr("is 0.5"), HasSubstr("delta = 1e-08"), HasSubstr("permitted")))));
}

// At delta = 1e-9 a collision takes 10^18 wall hits.
TEST(Ladder, ATimeThatNoMachineHasIsRejected) {
  for (const Target& target :
       {Target{}, Target{.samples = 1000}, Target{.collisions = 1'000'000}}) {
    EnsembleSpec spec = Relaxation(1e-9, target);
    spec.model = Model::kBilliard;
    ASSERT_TRUE(Violations(spec).empty());
    const std::vector<FieldViolation> found = TimeViolations(spec);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].field, target.collisions ? "target.collisions" : "target.samples");
    EXPECT_THAT(found[0].description,
                AllOf(HasSubstr("delta = 1e-09"), HasSubstr("up to 1e+10 s")));
    spec.grid[kDelta] = {0.01};
    EXPECT_TRUE(TimeViolations(spec).empty());
  }
  EXPECT_TRUE(TimeViolations(Asked(&kEquilibrium, 1e-100)).empty());  // the closed form answers
}

Machine InLanes24() {
  Machine machine = SomeMachine();
  machine.rates.lanes.lanes = 24;
  machine.workers = 2;
  return machine;
}

// A budget that ends before the first block is complete would be exceeded.
TEST(Ladder, ABudgetBelowTheFirstSamplesIsRejectedWithTheLeastBudget) {
  EnsembleSpec spec = Asked(&kEquilibrium, 3e-5, {.budget_seconds = 0.3});
  spec.model = Model::kBilliard;
  const std::vector<FieldViolation> found = MachineViolations(spec, InLanes24());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "target.budget");
  EXPECT_THAT(found[0].description, HasSubstr("is 0.3 s"));
  const std::string& text = found[0].description;
  const double least = std::stod(text.substr(text.find(">= ") + 3));
  EXPECT_GT(least, 50);
  EXPECT_LT(least, 500);
  spec.target.budget_seconds = least;
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
  const Ladder ladder = LadderFor(spec, PointAt(spec, 0), InLanes24(), MayNotBeAsked);
  EXPECT_GE(*ladder.Chosen().samples, 1);
  EXPECT_LE(*ladder.Chosen().work, 2 * least);
  // Two points need twice the budget.
  spec.grid[kDelta] = {3e-5, 4e-5};
  EXPECT_EQ(MachineViolations(spec, InLanes24()).size(), 1u);
  spec.target.budget_seconds = 2 * least;
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
}

// AUTO takes the jump process if the billiard has no samples within the budget.
TEST(Ladder, TheLeastBudgetOfAutoIsThatOfTheCheapestModel) {
  EnsembleSpec spec = Asked(&kGasConduction, 0.01, {.budget_seconds = 1e-6});
  const auto least = [&spec](Model model) {
    spec.model = model;
    spec.target.budget_seconds = 1e-6;
    const std::vector<FieldViolation> found = MachineViolations(spec, InLanes24());
    EXPECT_EQ(found.size(), 1u);
    const std::string& text = found.at(0).description;
    return std::stod(text.substr(text.find(">= ") + 3));
  };
  const double by_billiard = least(Model::kBilliard), by_auto = least(Model::kAuto);
  EXPECT_EQ(by_auto, least(Model::kMarkov));
  EXPECT_LT(by_auto, by_billiard / 10);
  spec.model = Model::kAuto;
  spec.target.budget_seconds = by_auto;
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
  const Ladder ladder = LadderFor(spec, PointAt(spec, 0), InLanes24(), MayNotBeAsked);
  EXPECT_EQ(ladder.answer.model, Model::kMarkov);
  EXPECT_GE(*ladder.Chosen().samples, 1);
}

TEST(Ladder, AShortBudgetIsAnsweredWithoutSamplesWherePossible) {
  EXPECT_TRUE(
      MachineViolations(Asked(&kEquilibrium, 3e-5, {.budget_seconds = 1e-6}), InLanes24()).empty());
  const EnsembleSpec spec = Relaxation(1e-5, {.budget_seconds = 0.01});
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
  EXPECT_EQ(Choice(spec, MayNotBeAsked, InLanes24())->model, Model::kSpectrum);
}

TEST(Ladder, AQuestionBeyondTheMemoryIsRejected) {
  Machine machine = SomeMachine();
  machine.memory = 1e8;
  const GasShape large = {.columns = 1000, .rows = 1000, .is_lattice = true};
  const EnsembleSpec spec = Conduction(large, Model::kBilliard, {.samples = 1});
  const std::vector<FieldViolation> found = MachineViolations(spec, machine);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "grid.cells[0]");
  EXPECT_THAT(found[0].description,
              AllOf(HasSubstr("is 1000x1000, which needs"), HasSubstr("up to 100 MB")));
  machine.memory = 4e9;  // a replica takes 0.4 GB, and its state 48 MB, of which there are 16
  EXPECT_TRUE(MachineViolations(spec, machine).empty());
  const Ladder ladder = LadderFor(spec, PointAt(spec, 0), machine, MayNotBeAsked);
  EXPECT_GT(ladder.Chosen().memory, 3e8);
  EXPECT_LT(ladder.Chosen().memory, 4e9);
}

// The conductivity has the error of the limit, whichever estimate is the first.
TEST(Ladder, TheLimitsErrorIsKnownForEveryEstimateThatHasOne) {
  EnsembleSpec rate = Asked(&kGasEquilibrium, 0.01);
  rate.model = Model::kSpectrum;
  const Answer answer = *Choice(rate, MayNotBeAsked);
  EXPECT_FALSE(answer.ModelErrorOf("exchange_rate", true));
  const double error = BoundOfConductivity(Conductivity(0.01));
  EXPECT_EQ(answer.ModelErrorOf("conductivity", false), error);
  EXPECT_EQ(answer.ModelErrorOf("conductivity_ratio", false), error);
  EnsembleSpec current = Asked(&kGasConduction, 0.01);
  current.model = Model::kMarkov;
  const Answer conduction = *Choice(current, MayNotBeAsked);
  EXPECT_GT(*conduction.model_error, 0);
  EXPECT_EQ(conduction.ModelErrorOf("conductivity", false), conduction.model_error);
  EXPECT_FALSE(conduction.ModelErrorOf("temperature_ball", false));
  current.model = Model::kBilliard;
  EXPECT_EQ(Choice(current, MayNotBeAsked)->ModelErrorOf("temperature_ball", false), 0);
}

}  // namespace
}  // namespace ballpiston
