// The checks find planted failures and nothing in good answers; the generator; the child process.
#include "core/experiment/all_experiments.h"
#include "server/convert/spec.h"
#include "tests/questions/questions.h"
#include "tests/support/message_text.h"

namespace ballpiston::questions {
namespace {

// ---- checks.h ----

const auto kQuestion =
    FromText<v1::EnsembleSpec>("experiment: EQUILIBRIUM grid { rho: 0.4 delta: 0.1 }");

// A later value replaces an earlier one.
v1::PointResult ResultWith(const std::string& estimate, const std::string& more = "") {
  return FromText<v1::PointResult>(
      "model: BILLIARD samples: 1000 estimates { name: 'mean_hit_time' value: 10 model_error: 0 " +
      estimate + " } " + more);
}

// The broken check, and what is wrong; empty if nothing is.
std::string Broken(const std::function<void()>& check) {
  try {
    check();
  } catch (const Violation& broken) {
    return absl::StrCat(broken.check, ": ", broken.what());
  }
  return "";
}

std::string OfAnswer(const std::string& estimate, const std::string& more = "") {
  return Broken([&] { CheckAnswer(kQuestion, ResultWith(estimate, more)); });
}

std::string OfPlan(const std::string& numbers, const std::string& more = "") {
  return Broken([&] {
    CheckPlan(FromText<v1::PointPlan>("model: BILLIARD models { model: BILLIARD answers: true " +
                                      numbers + " } " + more));
  });
}

std::string OfRefusal(const char* field, const char* description) {
  return Broken([&] { CheckRefusal(kQuestion, {{field, description}}); });
}

std::string OfSummary(double value) {
  PointSummary summary = {.samples = 64};
  summary.estimates = {{.name = "mean_hit_time", .value = value}};
  return Broken([&] { CheckFinite(summary); });
}

std::string OfMemory(double planned, double measured) {
  return Broken([&] { CheckMemory(planned, measured); });
}

std::string OfResults(const std::vector<v1::PointResult>& answers) {
  std::string all;
  for (const auto& [what, difference] : Disagreements(answers)) absl::StrAppend(&all, what, ";");
  return all;
}

// This estimate and another model's, which is 10 +- 0.1.
std::string OfModels(const std::string& estimate, const std::string& more = "") {
  return OfResults({ResultWith("standard_error: 0.1"), ResultWith(estimate, more)});
}

std::string OfAModelWithoutKnownError() {
  v1::PointResult unknown = ResultWith("value: 20 standard_error: 0.1");
  unknown.mutable_estimates(0)->clear_model_error();
  return OfResults({ResultWith("standard_error: 0.1"), unknown});
}

TEST(Checks, FindEachDefectAndNothingElse) {
  const char *const kNothing = "", *const kRange = "rho is 0.4; permitted: (1/2, 1/sqrt(2))";
  const char* const kDiffer = "mean_hit_time by BILLIARD and BILLIARD;";
  const std::string error = "standard_error: 0.1";
  const struct {
    const char* name;
    std::string found;
    const char* broken;
  } rows[] = {
      {"a good answer", OfAnswer(error), kNothing},
      {"an exact value is NaN", OfAnswer(error + " exact: nan"), "finite: exact: nan"},
      {"an exact value is infinite", OfAnswer(error + " exact: inf"), "finite: exact: inf"},
      {"an error of 0", OfAnswer("standard_error: 0"), "false zero: mean_hit_time is 10 +- 0 "},
      {"an error below the rounding", OfAnswer("standard_error: 1e-17"),
       "false zero: mean_hit_time"},
      {"no error", OfAnswer(""), "measured: mean_hit_time has"},
      {"no error, and a remark", OfAnswer("", "remarks: 'too few returns'"), kNothing},
      {"no samples", OfAnswer(error, "samples: 0"), "measured: 0 samples"},
      {"an escape", OfAnswer(error, "health { escapes: 1 }"), "health: escapes: 1"},
      {"a law that does not sum to 1",
       OfAnswer(error, "histograms { expected_probabilities: 0.99999 }"), "law: "},
      {"a summary with NaN", OfSummary(std::numeric_limits<double>::quiet_NaN()),
       "finite: a number of mean_hit_time is nan"},
      {"a good summary", OfSummary(1), kNothing},
      {"a good plan", OfPlan("samples: 64 work: 0.1"), kNothing},
      {"a plan without samples", OfPlan("samples: 0 work: 0.1"), "plan: no samples"},
      {"a plan without work", OfPlan("samples: 64"), "plan: no machine"},
      {"a plan that takes too long", OfPlan("samples: 64 work: 1e115"), "plan: no machine"},
      {"a plan by a model that does not answer", OfPlan("samples: 64 work: 0.1", "model: MARKOV"),
       "plan: no model answers"},
      {"a good refusal", OfRefusal("spec.grid.rho[0]", kRange), kNothing},
      {"a refusal of a value that is not there", OfRefusal("spec.grid.rho[1]", kRange),
       "refusal: names no field"},
      {"a refusal of an unknown field", OfRefusal("spec.grid.radius[0]", kRange),
       "refusal: names no field"},
      {"a field of a newer client", OfRefusal("spec.grid", "unknown field number 99"), kNothing},
      {"an unknown field elsewhere", OfRefusal("grid", "unknown field number 99"),
       "refusal: names no field"},
      {"a refusal without the value",
       OfRefusal("spec.grid.rho[0]", "rho is wrong; permitted: (1/2, 1/sqrt(2))"),
       "refusal: does not show the value"},
      {"a refusal without the range", OfRefusal("spec.grid.rho[0]", "rho is 0.4"),
       "refusal: does not say"},
      {"two models that agree", OfModels("value: 10.7 standard_error: 0.1"), kNothing},
      {"two models that differ", OfModels("value: 10.8 standard_error: 0.1"), kDiffer},
      {"two models that differ by a model error",
       OfModels("value: 10.8 standard_error: 0.1 model_error: 0.2"), kNothing},
      {"distances between laws from equal samples",
       OfModels("value: 10.8 standard_error: 0.1 noise_floor: 0.1"), kDiffer},
      {"distances between laws from other samples",
       OfModels("value: 10.8 standard_error: 0.1 noise_floor: 0.1", "samples: 2000"), kNothing},
      {"a model without known error", OfAModelWithoutKnownError(), kNothing},
      {"a model that differs from the exact value", OfResults({ResultWith(error + " exact: 10.6")}),
       "mean_hit_time by BILLIARD and its exact value;"},
      {"as much memory as planned", OfMemory(1e8, 1e8 + kMemoryOfAnyAnswer), kNothing},
#ifndef BALLPISTON_SANITIZED
      {"too much memory", OfMemory(1e6, 1e8), "memory: planned 1 MB"},
#endif
  };
  for (const auto& [name, found, broken] : rows) {
    EXPECT_TRUE(absl::StartsWith(found, broken) && found.empty() == (broken == kNothing))
        << name << ": " << found;
  }
}

// ---- questions.h ----

constexpr double kMostSeconds = 0.01;

// 12 of 300 questions are fewer than half of the expected number of each experiment.
TEST(Draw, AsksEveryExperimentByEveryModelWithEveryTarget) {
  std::map<int, int> experiments, models, targets, precisions;
  int permitted = 0;
  for (uint64_t number = 0; number < 300; ++number) {
    const v1::EnsembleSpec question = Draw(1, number, kMostSeconds);
    ++experiments[question.experiment()];
    ++models[question.model()];
    ++targets[question.target().kind_case()];
    ++precisions[question.precision()];
    permitted += server::CheckSpec(question).violations.empty();
  }
  EXPECT_THAT(experiments, SizeIs(AllExperiments().size()));
  EXPECT_THAT(models, SizeIs(6));
  EXPECT_THAT(targets, SizeIs(4));
  EXPECT_THAT(precisions, SizeIs(2));
  for (const auto& [experiment, count] : experiments) EXPECT_GT(count, 12) << experiment;
  EXPECT_GT(permitted, 150);
}

TEST(Child, ReportsABrokenCheckAndADeath) {
  const auto break_law = []() -> std::string { throw Violation("law", "of two\nlines"); };
  EXPECT_EQ(Broken([&] { InChild(break_law); }), "law: of two\nlines");
  const std::pair<int, const char*> deaths[] = {
      {SIGKILL, "crash"},
      {SIGXCPU, "end"},  // as the kernel does when the time is used up
      {0, "crash"}};     // no signal, and nothing is reported
  for (const auto& [signal, check] : deaths) {
    const std::string found = Broken([signal = signal] {
      InChild([signal] {
        raise(signal);
        return "";
      });
    });
    EXPECT_THAT(found, StartsWith(check));
  }
}

}  // namespace
}  // namespace ballpiston::questions
