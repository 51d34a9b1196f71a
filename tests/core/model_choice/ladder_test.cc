#include "core/model_choice/ladder.h"

#include <regex>

#include "core/billiard/billiard_domain.h"
#include "core/experiment/expected_limit_error.h"
#include "tests/core/model_choice/questions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// ---- choices ----

struct Chosen {
  const char* question;
  Model model;
  const char* reason = "";
};

TEST(Ladder, ModelsAreChosenWithAReason) {
  constexpr Model kClosed = Model::kClosedForm, kBilliard = Model::kBilliard;
  constexpr Model kSpectrum = Model::kSpectrum, kMarkov = Model::kMarkov;
  for (const Chosen& row : {
           // A closed form is exact for every target, unless the question is to verify it.
           Chosen{"equilibrium", kClosed, "exact"},
           {"conditional-mean-free-time budget=1", kClosed, "exact"},
           {"equilibrium verify=yes", kBilliard, "verify"},
           // Only the billiard measures laws: no target makes another model answer.
           {"first-hit budget=1", kBilliard, "no cheaper model answers first-hit"},
           {"markov-property budget=1", kBilliard, "error is not known for markov-property"},
           // Without a tolerance the answer is that of an exact model.
           {"energy-relaxation delta=1e-4", kBilliard, "without a tolerance"},
           {"gas-conduction delta=1e-3", kBilliard, "without a tolerance"},
           {"gas-equilibrium delta=1e-4 estimate=conductivity", kBilliard, "without a tolerance"},
           // Around the mean energy there is no relaxation time, and the limit's error is unknown.
           {"energy-relaxation delta=0.01 epsilon=0.15", kBilliard, "is not known at this point"},
           {"energy-relaxation delta=0.01 epsilon=0.15 budget=1e-3", kBilliard, "at this point"},
           {"energy-relaxation rho=0.53 delta=0.01 tolerance=0.003", kSpectrum,
            "the limit's error, up to 0.00059, is within the tolerance"},
           // For a piston that hardly moves the limit does not apply at any delta.
           {"energy-relaxation delta=0.0125 tolerance=0.02 epsilon=1e-6", kBilliard,
            "is beyond the tolerance"},
           // The discs nearly touch: the billiard would take years.
           {"energy-relaxation rho=0.50000378 delta=7e-9 epsilon=0 tolerance=0.1", kSpectrum,
            "is within the tolerance"},
           // Beyond the billiard's domain the limit answers.
           {"energy-relaxation delta=1e-12 tolerance=0.01", kSpectrum, "not sound at this point"},
           // A budget weighs the statistical error against that of the model.
           {"gas-conduction delta=0.0125 budget=1e-3", kMarkov},
           {"gas-conduction delta=0.0125 budget=1e5", kBilliard},
           {"gas-equilibrium delta=1e-4 estimate=conductivity budget=1", kSpectrum},
           {"gas-equilibrium delta=0.2 estimate=conductivity budget=1e6", kBilliard},
           // Next to a very cold reservoir the jump process is nine times too large.
           {"gas-conduction hot=1 cold=1e-6 tolerance=0.12", kBilliard},
       }) {
    SCOPED_TRACE(row.question);
    const EnsembleSpec spec = Asked(row.question);
    const Answer answer = Choice(spec);
    EXPECT_EQ(answer.model, row.model) << Name(answer.model);
    EXPECT_THAT(answer.reason, HasSubstr(row.reason));
    EXPECT_EQ(answer.model_error > 0, IsOfTheLimit(row.model));
  }
}

// ---- bounds that decide ----

double BoundOf(const EnsembleSpec& spec) {
  return AimOf(spec).LimitErrorAt(PointAt(spec, 0)).value();
}

// The jump process adds a statistical error, for which half of the tolerance is left. The bound is
// large near the energies without a relaxation time, and where a body hardly moves. Every machine
// makes the same choice.
TEST(Ladder, TheLimitAnswersWhereItsBoundIsWithinTheTolerance) {
  Machine slower = SomeMachine();
  slower.rates.lanes.wall_hit *= 100;
  slower.workers = 64;
  int by_limit = 0;
  for (const char* question :
       {"energy-relaxation", "energy-relaxation epsilon=0", "energy-relaxation epsilon=1e-6",
        "energy-relaxation epsilon=0.12", "energy-relaxation epsilon=0.2",
        "energy-relaxation epsilon=0.499999", "energy-relaxation epsilon=0.5",
        "energy-relaxation rho=0.5001", "energy-relaxation rho=0.705", "gas-conduction",
        "gas-equilibrium estimate=conductivity"}) {
    EnsembleSpec spec = Asked(question);
    const double rho = spec.grid[kRho][0];
    const double most = IsOfAGas(spec.experiment) ? GasDeltaBound(rho) : PairDeltaBound(rho);
    const bool samples = spec.experiment == &kGasConduction;
    const Model model = samples ? Model::kMarkov : Model::kSpectrum;
    const double share = samples ? 0.5 : 1;
    for (double delta = most; delta > 1e-4 * most; delta /= 3) {
      spec.grid[kDelta] = {delta};
      const double bound = BoundOf(spec);
      for (const double of_bound : {1.001, 0.999}) {
        spec.target.tolerance = std::min(bound / share * of_bound, 0.99);
        const bool is_within = bound <= share * *spec.target.tolerance;
        SCOPED_TRACE(absl::StrCat(question, " delta=", delta, " ", *spec.target.tolerance));
        const Answer answer = Choice(spec);
        EXPECT_EQ(answer.model, is_within ? model : Model::kBilliard);
        EXPECT_EQ(answer.model_error, is_within ? bound : 0);
        EXPECT_THAT(answer.reason,
                    HasSubstr(absl::StrCat("is ", is_within ? "within " : "beyond ",
                                           samples ? "half of " : "", "the tolerance")));
        EXPECT_EQ(answer.reason, Choice(spec, slower).reason);
        by_limit += is_within;
      }
    }
  }
  EXPECT_GT(by_limit, 50);
}

// The conductivity of a ring of jump processes over that of the infinite chain, less 1
// (docs/research/conductivity.md).
TEST(Ladder, TheSpectrumsConductivityHasTheErrorOfSmallRings) {
  for (const auto& [cells, difference] : {std::pair(3, 1.56e-4), {5, 3.2e-5}, {6, 1.6e-5}}) {
    const std::string ring = "gas-equilibrium rho=0.53 delta=1e-5 estimate=conductivity cells=";
    EXPECT_GT(BoundOf(Asked(absl::StrCat(ring, cells))), difference) << cells;
  }
}

// The errors in a plan's table are those of the answer, and of the named estimate.
TEST(Ladder, ThePlanRefersToTheNamedEstimate) {
  for (const auto& [question, subject] :
       {std::pair("energy-relaxation delta=0.01 tolerance=0.01", "energy-relaxation"),
        {"energy-relaxation delta=0.01 model=markov", "energy-relaxation"},
        {"gas-equilibrium delta=0.01 tolerance=0.05 estimate=conductivity", "conductivity"}}) {
    const EnsembleSpec spec = Asked(question);
    const Ladder ladder = Planned(spec);
    EXPECT_EQ(ladder.answer.model_error, BoundOf(spec));
    for (const size_t i : {1, 2}) {
      EXPECT_EQ(ladder.rungs[i].model_error, BoundOf(spec));
      EXPECT_EQ(ladder.rungs[i].reason, "the limit delta -> 0; the model error is an upper bound");
    }
    EXPECT_EQ(ladder.rungs[1].statistical_error, 0);
    EXPECT_FALSE(ladder.rungs[0].answers);
    EXPECT_EQ(ladder.rungs[0].reason, absl::StrCat("there is no closed form for ", subject));
  }
  const Ladder of_rate =
      Planned(Asked("gas-equilibrium delta=0.01 tolerance=0.05 estimate=exchange_rate"));
  EXPECT_EQ(of_rate.answer.model, Model::kClosedForm);
  EXPECT_FALSE(of_rate.rungs[1].model_error);
}

// The conductivity has the error of the limit, whichever estimate is the first.
TEST(Ladder, TheLimitsErrorIsKnownForEveryEstimateThatHasOne) {
  const Answer answer = Choice(Asked("gas-equilibrium delta=0.01 model=spectrum"));
  EXPECT_FALSE(answer.ModelErrorOf("exchange_rate", true));
  const double error = BoundOf(Asked("gas-equilibrium delta=0.01 estimate=conductivity"));
  EXPECT_EQ(answer.ModelErrorOf("conductivity", false), error);
  EXPECT_EQ(answer.ModelErrorOf("conductivity_ratio", false), error);
  const Answer conduction = Choice(Asked("gas-conduction delta=0.01 model=markov"));
  EXPECT_GT(*conduction.model_error, 0);
  EXPECT_EQ(conduction.ModelErrorOf("conductivity", false), conduction.model_error);
  EXPECT_FALSE(conduction.ModelErrorOf("temperature_ball", false));
  EXPECT_EQ(Choice(Asked("gas-conduction delta=0.01 model=billiard"))
                .ModelErrorOf("temperature_ball", false),
            0);
}

// ---- budgets ----

// With a budget alone AUTO chooses the model with the smallest error within the budget.
TEST(Ladder, BudgetChoosesTheBilliardIfItsErrorIsSmaller) {
  double turn = 0;
  for (double seconds = 1e-3; seconds < 1e5; seconds *= 2) {
    const Answer answer = Choice(Relaxation(0.0125, {.budget_seconds = seconds}));
    if (turn == 0 && answer.model == Model::kBilliard) turn = seconds;
    EXPECT_EQ(answer.model, turn == 0 ? Model::kSpectrum : Model::kBilliard) << seconds;
    EXPECT_EQ(*answer.model_error, turn == 0 ? ExpectedLimitError(PaperPoint(0.0125)) : 0);
  }
  EXPECT_GT(turn, 1);
  EXPECT_LT(turn, 1e4);
}

// The point ends with the tolerance or the budget, whichever is reached first.
TEST(Ladder, BudgetWithToleranceChoosesTheBilliardIfItReachesTheTolerance) {
  const double limit = ExpectedLimitError(PaperPoint(0.0125));
  for (const auto& [tolerance, seconds, model] :
       {std::tuple(0.5, 1.0, Model::kBilliard),
        {1.01 * limit, 1.0, Model::kSpectrum},
        {0.99 * limit, 1.0, Model::kBilliard},  // the limit is beyond the tolerance
        {1e-5, 1e5, Model::kBilliard}}) {
    const Target target = {.tolerance = tolerance, .budget_seconds = seconds};
    EXPECT_EQ(Choice(Relaxation(0.0125, target)).model, model) << tolerance;
  }
}

// Near 1/sqrt 2 the limit's error is large, and the billiard is not sound.
TEST(Ladder, ABudgetDoesNotLetTheLimitMissATolerance) {
  for (const std::optional<double> tolerance : {std::optional<double>(), {0.9}, {0.01}}) {
    EnsembleSpec spec = Relaxation(1.2e-10, {.tolerance = tolerance, .budget_seconds = 1});
    spec.grid[kRho] = {kMaxRho - 1e-10};
    EXPECT_EQ(AnswerViolations(spec).empty(), tolerance != 0.01);
  }
}

Machine InLanes24() {
  Machine machine = SomeMachine();
  machine.rates.lanes.lanes = 24;
  machine.workers = 2;
  return machine;
}

double LeastBudget(EnsembleSpec spec) {
  const std::vector<FieldViolation> found = MachineViolations(spec, InLanes24());
  EXPECT_THAT(found, ElementsAre(OfField("target.budget")));
  const std::string& text = found.at(0).description;
  const double least = std::stod(text.substr(text.find(">= ") + 3));
  spec.target.budget_seconds = least;
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
  EXPECT_GE(*Planned(spec, InLanes24()).Chosen().samples, 1);
  EXPECT_LE(*Planned(spec, InLanes24()).Chosen().work, 2 * least);
  return least;
}

// A budget that ends before the first block is complete would be exceeded.
TEST(Ladder, ABudgetBelowTheFirstSamplesIsRejectedWithTheLeastBudget) {
  const double least = LeastBudget(Asked("equilibrium delta=3e-5 budget=0.3 model=billiard"));
  EXPECT_GT(least, 50);
  EXPECT_LT(least, 500);
  EXPECT_NEAR(LeastBudget(Asked("equilibrium delta=3e-5,4e-5 budget=0.3 model=billiard")),
              2 * least, 1e-3 * least);
  const auto found =
      MachineViolations(Asked("equilibrium delta=1e-9 budget=1e6 model=billiard"), InLanes24());
  EXPECT_THAT(found, ElementsAre(Saying("no budget, because the first samples take longer than")));
}

// AUTO takes the jump process if the billiard has no samples within the budget.
TEST(Ladder, TheLeastBudgetOfAutoIsThatOfTheCheapestModel) {
  const std::string question = "gas-conduction delta=0.01 budget=1e-6";
  const double by_auto = LeastBudget(Asked(question));
  EXPECT_EQ(by_auto, LeastBudget(Asked(question + " model=markov")));
  EXPECT_LT(by_auto, LeastBudget(Asked(question + " model=billiard")) / 10);
  EXPECT_TRUE(MachineViolations(Asked("equilibrium delta=3e-5 budget=1e-6"), InLanes24()).empty());
  const EnsembleSpec spec = Asked("energy-relaxation delta=1e-5 budget=0.01");
  EXPECT_TRUE(MachineViolations(spec, InLanes24()).empty());
  EXPECT_EQ(Choice(spec, InLanes24()).model, Model::kSpectrum);
}

// ---- samples ----

TEST(Ladder, SamplesAreThoseThatTheTargetNeeds) {
  const auto rung = [](const std::string& question, Model model) {
    const Ladder ladder = Planned(Asked(question));
    return *std::ranges::find(ladder.rungs, model, &Rung::model);
  };
  const std::string relaxation = "energy-relaxation";
  for (const Model model : {Model::kMarkov, Model::kBilliard, Model::kBilliardReference}) {
    EXPECT_EQ(rung(relaxation + " samples=123", model).samples, 123);
    // A sample has 40 collisions.
    for (const auto& [collisions, samples] : {std::pair(1, 1), {4000, 100}, {4001, 101}}) {
      EXPECT_EQ(rung(absl::StrCat(relaxation, " collisions=", collisions), model).samples, samples);
    }
    EXPECT_EQ(rung(relaxation, model).samples, kDefaultSamples);
    const Rung to_tolerance = rung(relaxation + " tolerance=0.002", model);
    EXPECT_LE(*to_tolerance.statistical_error, 0.002);
    EXPECT_GT(*to_tolerance.statistical_error, 0.0015);
    const Rung in_time = rung(relaxation + " budget=3", model);
    EXPECT_LE(*in_time.work, 3);
    EXPECT_GT(*in_time.work, 2.9);
    // The tolerance first, if the time allows it.
    const Rung either = rung(relaxation + " tolerance=0.3 budget=100", model);
    EXPECT_LT(*either.work, 100);
    EXPECT_EQ(*either.samples, *rung(relaxation + " tolerance=0.3", model).samples);
  }
  for (const Rung& exact :
       {rung(relaxation, Model::kSpectrum), rung("equilibrium", Model::kClosedForm)}) {
    EXPECT_EQ(exact.samples, 0);
    EXPECT_EQ(exact.statistical_error, 0);
  }
  // A first hit's work counts its summary: 200 points of one sample each took 0.8 s.
  const double work = *Planned(Asked("first-hit samples=1")).Chosen().work;
  EXPECT_GT(work, 1e-3);
  EXPECT_LT(work, 5e-3);
}

// A plan and its result have an error from the same number of samples on.
TEST(Ladder, SamplesBelowThoseOfAnErrorHaveNoPlannedError) {
  for (const int collisions : {499, 500}) {
    const EnsembleSpec spec =
        Asked(absl::StrCat("equilibrium model=billiard collisions=", collisions));
    EXPECT_EQ(Planned(spec).Chosen().statistical_error.has_value(), collisions == 500);
  }
  EXPECT_FALSE(
      Planned(Asked("energy-relaxation delta=0.01 epsilon=0.15")).Chosen().statistical_error);
  // From epsilon = 1/2 only the orbits meet whose ball starts within the piston's reach.
  const EnsembleSpec spec = Asked("energy-relaxation delta=0.05 epsilon=0.5 model=billiard");
  const Scatter scatter = ScatterOf(spec, PointAt(spec, 0));
  EXPECT_GT(scatter.SamplesForAnError(), 1000);
  EXPECT_GE(scatter.SamplesFor(0.5), scatter.SamplesForAnError());
}

// ---- single precision ----

// In single precision the billiard is not exact, for every reason of its choice.
TEST(Ladder, SinglePrecisionHasAModelErrorInLanesOnly) {
  for (const char* question :
       {"equilibrium verify=yes", "first-hit model=billiard", "first-hit", "energy-relaxation",
        "energy-relaxation tolerance=0.01 epsilon=0.11",
        "energy-relaxation delta=0.2 tolerance=0.01", "energy-relaxation delta=0.3 budget=100"}) {
    const EnsembleSpec spec = Asked(absl::StrCat(question, " precision=single"));
    const Answer answer = Choice(spec);
    EXPECT_EQ(answer.model, Model::kBilliard);
    EXPECT_EQ(answer.model_error, kSinglePrecisionError);
    EXPECT_THAT(answer.reason, Not(HasSubstr("exact")));
    const Ladder ladder = Planned(spec);
    EXPECT_EQ(ladder.Chosen().model_error, kSinglePrecisionError);
    EXPECT_THAT(ladder.Chosen().reason, AllOf(HasSubstr("single"), Not(HasSubstr("exact"))));
    // The reference is always in double precision.
    EXPECT_EQ(ladder.rungs.back().model_error, 0);
    EXPECT_EQ(ladder.rungs.back().reason, "exact");
  }
  EXPECT_EQ(Choice(Asked("equilibrium precision=single")).model_error, 0);
  EXPECT_EQ(Choice(Asked("energy-relaxation delta=0.0125 tolerance=0.01 precision=single")).model,
            Model::kSpectrum);
  // Distances between laws tend to 0, so their relative error has no meaning.
  const Answer laws = Choice(Asked("markov-property precision=single"));
  EXPECT_FALSE(laws.model_error);
  EXPECT_THAT(laws.reason, Not(HasSubstr("exact")));
}

// ---- what cannot be done ----

TEST(Ladder, AToleranceBelowTheModelsErrorIsRejected) {
  const double limit = ExpectedLimitError(PaperPoint(0.2));
  struct Row {
    std::string question;
    double least;  // a tolerance
    const char* text;
  };
  for (const Row& row :
       {Row{"energy-relaxation model=spectrum", limit, "model auto or billiard"},
        {"energy-relaxation precision=single", kSinglePrecisionError, "or precision double"},
        {"first-hit precision=single model=billiard", kSinglePrecisionError,
         "or precision double"}}) {
    EnsembleSpec spec = Asked(row.question + " delta=0.2");
    spec.target.tolerance = 0.99 * row.least;
    EXPECT_THAT(AnswerViolations(spec), ElementsAre(Names("target.tolerance", row.text)));
    spec.target.tolerance = 1.01 * row.least;
    EXPECT_THAT(AnswerViolations(spec), IsEmpty());
  }
  // A tolerance of 1 is not permitted.
  const auto found = AnswerViolations(
      Asked("energy-relaxation delta=0.1 epsilon=0.11 model=spectrum tolerance=0.999"));
  EXPECT_THAT(found, ElementsAre(Saying("permitted: samples or a budget")));
  for (const char* question :
       {"equilibrium delta=0.2 model=closed_form tolerance=1e-17",
        "gas-equilibrium delta=0.1 cells=4 tolerance=9e-13",
        // The numerical error of the spectrum, and the rounding of a mean.
        "energy-relaxation delta=1e-15 epsilon=0.3 tolerance=2.7e-9",
        "first-hit delta=1e-10 epsilon=0.5 tolerance=2.9e-14",
        "gas-equilibrium estimate=conductivity delta=0.03 cells=1 model=markov tolerance=9e-10",
        // The largest permitted number of samples limits the tolerance of a model that samples.
        "energy-relaxation delta=0.2 tolerance=1e-9",
        "energy-relaxation delta=0.2 tolerance=1e-9 model=billiard_reference",
        // The worst point of the grid counts.
        "energy-relaxation delta=0.01,0.2 tolerance=0.01 model=spectrum"}) {
    EXPECT_THAT(AnswerViolations(Asked(question)), SizeIs(1)) << question;
  }
  for (const char* question :
       {"equilibrium delta=0.2 model=closed_form tolerance=1e-12",
        "gas-equilibrium delta=0.1 cells=4 tolerance=1.1e-12",
        "energy-relaxation delta=1e-15 epsilon=0.3 tolerance=2.8e-9",
        "gas-equilibrium estimate=conductivity delta=0.03 cells=1 model=markov tolerance=1e-9",
        // The tolerance of the jump process is that of its samples.
        "energy-relaxation delta=0.2 model=markov tolerance=0.01",
        "energy-relaxation delta=0.2 tolerance=1e-5",
        // AUTO answers by the spectrum, which takes no samples.
        "energy-relaxation delta=1e-6 tolerance=1e-8 precision=single",
        "energy-relaxation delta=0.01 tolerance=0.01 model=spectrum"}) {
    EXPECT_THAT(AnswerViolations(Asked(question)), IsEmpty()) << question;
  }
  EXPECT_THAT(AnswerViolations(
                  Asked("energy-relaxation delta=1e-8 epsilon=0.5 tolerance=0.5 model=billiard")),
              ElementsAre(Saying("is 0.5", "delta = 1e-08", "permitted")));
}

// Distances between laws and a current without a fall of temperature tend to 0. Around 1/6 the
// integral of the decay has a zero, and the relaxation time a pole. At rest the variance of return
// times is infinite; the closed form needs none, and a relaxation from rest ends with its window.
TEST(Ladder, AToleranceIsRejectedWhereAnEstimateHasNoRelativeError) {
  for (const auto& [question, at] : std::vector<std::pair<std::string, const char*>>{
           {"markov-property", "delta = 0.1 "},
           {"markov-property model=markov", "delta = 0.1 "},
           {"gas-conduction hot=2,1 cold=1", "hot = 1, cold = 1"},
           {"energy-relaxation epsilon=0.12,0.121,0.2", "epsilon = 0.121"},
           {"energy-relaxation epsilon=0.199", "epsilon = 0.199"},
           {"energy-relaxation epsilon=0.1667 model=spectrum", "epsilon = 0.1667"},
           {"first-hit epsilon=0", "epsilon = 0,"},
           {"conditional-mean-free-time epsilon=0.1,0 model=billiard", "epsilon = 0 "},
           {"conditional-mean-free-time epsilon=0 verify=yes", "epsilon = 0 "}}) {
    EXPECT_THAT(AnswerViolations(Asked(question + " tolerance=0.1")),
                ElementsAre(Names("target.tolerance", "is 0.1, but at ", at, "; permitted: ")))
        << question;
  }
  for (const std::string question :
       {"energy-relaxation epsilon=0,0.12,0.2", "conditional-mean-free-time epsilon=0,0.1",
        "conditional-mean-free-time epsilon=0,0.1 model=closed_form"}) {
    EXPECT_THAT(AnswerViolations(Asked(question + " tolerance=0.1")), IsEmpty()) << question;
  }
}

// AUTO answers by another model where one answers, and is rejected elsewhere.
TEST(Ladder, AutoNeedsAnotherModelOutsideTheBilliardsDomain) {
  for (const char* question :
       {"equilibrium delta=1e-12", "energy-relaxation delta=1e-12 tolerance=0.01",
        "energy-relaxation delta=1e-12 budget=1", "energy-relaxation delta=0.01"}) {
    EXPECT_THAT(AnswerViolations(Asked(question)), IsEmpty()) << question;
  }
  for (const char* question : {"equilibrium delta=1e-12 verify=yes", "markov-property delta=1e-12",
                               "energy-relaxation delta=1e-12",  // no tolerance: an exact model
                               "energy-relaxation delta=1e-12,0.01",
                               // There is no relaxation time, and the limit's error is not known.
                               "energy-relaxation delta=1e-12 epsilon=0.1,0.1667 budget=1"}) {
    EXPECT_THAT(AnswerViolations(Asked(question)),
                ElementsAre(Names("grid.delta[0]", "delta is 1e-12", "delta >= 1e-10")))
        << question;
  }
}

// A question that needs years is planned. One that needs longer than any machine lasts is rejected.
// The number in the message is permitted.
TEST(Ladder, ATimeThatNoMachineHasIsRejected) {
  const std::string question = "energy-relaxation model=billiard ";
  for (const std::string target : {"samples=100000", "collisions=1e7", "seed=1"}) {
    const std::string field = target[0] == 'c' ? "target.collisions" : "target.samples";
    const auto found = AnswerViolations(Asked(question + target + " delta=1e-7"));
    ASSERT_THAT(found, ElementsAre(OfField(field)));
    const std::string& description = found[0].description;
    EXPECT_THAT(description, AllOf(HasSubstr("at rho = "), HasSubstr("delta = 1e-07")));
    std::smatch permitted;
    ASSERT_TRUE(std::regex_search(description, permitted, std::regex("there: up to ([0-9]+),")))
        << description;
    const std::string kind = field.substr(field.find('.') + 1);
    EXPECT_THAT(AnswerViolations(Asked(question + kind + "=" + permitted.str(1) + " delta=1e-7")),
                IsEmpty());
    EXPECT_THAT(AnswerViolations(Asked(question + target + " delta=0.01")), IsEmpty());
  }
  // At delta = 1e-10 a collision takes 10^20 wall hits.
  EXPECT_THAT(AnswerViolations(Asked(question + "samples=1000 delta=1e-10")),
              ElementsAre(Saying("even one takes longer")));
  EXPECT_THAT(AnswerViolations(Asked("equilibrium delta=1e-100")), IsEmpty());  // the closed form
  const std::string gas = "gas-conduction tolerance=0.05 model=markov cells=";
  EXPECT_THAT(AnswerViolations(Asked(gas + "50000")), IsEmpty());
  const Ladder ladder = Planned(Asked(gas + "50000"));
  EXPECT_GT(ladder.Chosen().time, 1e8);
  EXPECT_LE(*ladder.Chosen().statistical_error, 0.05);
  EXPECT_THAT(AnswerViolations(Asked(gas + "1000000")), SizeIs(1));
}

// A chain of 100 had to wait hours for its first chunk, and one of 300 was refused.
TEST(Ladder, ChainsOfHundredsTakeMinutes) {
  const std::string gas = "gas-conduction delta=0.05 hot=2 cold=1 tolerance=0.05 model=billiard";
  EXPECT_LT(Planned(Asked(gas + " cells=100")).Chosen().time, 1200);
  EXPECT_LT(Planned(Asked(gas + " cells=300")).Chosen().time, 3 * 3600);
}

TEST(Ladder, AQuestionBeyondTheMemoryIsRejected) {
  Machine machine = SomeMachine();
  machine.memory = 100.9e6;
  const EnsembleSpec spec = Asked("gas-conduction cells=1000x1000 model=billiard samples=1");
  EXPECT_THAT(MachineViolations(spec, machine),
              ElementsAre(Names("grid.cells[0]", "is 1000x1000, which needs", "up to 100 MB")));
  machine.memory = 4e9;  // a replica takes 0.4 GB, and its state 48 MB, of which there are 16
  EXPECT_TRUE(MachineViolations(spec, machine).empty());
  EXPECT_GT(Planned(spec, machine).Chosen().memory, 3e8);
  EXPECT_LT(Planned(spec, machine).Chosen().memory, 4e9);
}

}  // namespace
}  // namespace ballpiston
