// The checks find planted failures and nothing in good answers; the generator; the child process.
#include "client/command/spec_file.h"
#include "core/experiment/all_experiments.h"
#include "server/convert/spec.h"
#include "tests/questions/checks.h"
#include "tests/questions/engine.h"
#include "tests/questions/question.h"
#include "tests/support/message_text.h"

namespace ballpiston::questions {
namespace {

// ---- checks.h ----

auto Breaks(const char* check) { return ElementsAre(Field(&Finding::check, check)); }

v1::EnsembleSpec QuestionWithASmallRho() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->add_rho(0.4);
  spec.mutable_grid()->add_delta(0.1);
  return spec;
}

// A later value replaces an earlier one.
v1::PointResult ResultWith(const std::string& estimate, const std::string& more = "") {
  return FromText<v1::PointResult>(
      "model: BILLIARD samples: 1000 estimates { name: 'mean_hit_time' value: 10 model_error: 0 " +
      estimate + " } " + more);
}

TEST(Checks, EveryDefectOfAnAnswerIsFound) {
  const std::string error = "standard_error: 0.1";
  const struct {
    v1::PointResult result;
    const char* broken;  // null: none
  } rows[] = {{ResultWith(error), nullptr},
              {ResultWith(error + " exact: nan"), kFiniteCheck},
              {ResultWith("standard_error: 0"), kFalseZeroCheck},
              {ResultWith("standard_error: 1e-17"), kFalseZeroCheck},
              {ResultWith(""), kMeasuredCheck},
              {ResultWith("", "remarks: 'too few returns'"), nullptr},
              {ResultWith(error, "samples: 0"), kMeasuredCheck},
              {ResultWith(error, "health { escapes: 1 }"), kHealthCheck},
              {ResultWith(error, "histograms { expected_probabilities: 0.99999 }"), kLawCheck}};
  for (const auto& [result, broken] : rows) {
    SCOPED_TRACE(result.ShortDebugString());
    const Findings findings = CheckAnswer(QuestionWithASmallRho(), result);
    if (broken == nullptr) {
      EXPECT_THAT(findings, IsEmpty());
    } else {
      EXPECT_THAT(findings, Breaks(broken));
    }
  }
}

TEST(Checks, ASummaryWithoutANumberIsFound) {
  PointSummary summary = {.samples = 64};
  summary.estimates = {
      {.name = "mean_hit_time", .value = std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_THAT(CheckFinite(summary), Breaks(kFiniteCheck));
  summary.estimates = {{.name = "mean_hit_time", .value = 1}};
  EXPECT_THAT(CheckFinite(summary), IsEmpty());
}

TEST(Checks, EveryDefectOfAPlanIsFound) {
  const auto plan = [](const std::string& numbers, const std::string& more = "") {
    return CheckPlan(FromText<v1::PointPlan>(
        "model: BILLIARD models { model: BILLIARD answers: true " + numbers + " } " + more));
  };
  EXPECT_THAT(plan("samples: 64 work: 0.1"), IsEmpty());
  EXPECT_THAT(plan("samples: 0 work: 0.1"), Breaks(kPlanCheck));
  EXPECT_THAT(plan("samples: 64"), Breaks(kPlanCheck));
  EXPECT_THAT(plan("samples: 64 work: 1e115"), Breaks(kPlanCheck));
  EXPECT_THAT(plan("samples: 64 work: 0.1", "model: MARKOV"), Breaks(kPlanCheck));
}

TEST(Checks, MemoryBeyondThePlanIsFound) {
  const PeakMemory peak;
  const std::vector<char> bytes(100'000'000, 1);
  EXPECT_GT(peak.Bytes(), 0.9e8);
  EXPECT_LT(peak.Bytes(), 1.5e8);
#ifndef BALLPISTON_SANITIZED
  EXPECT_THAT(CheckMemory(1e6, 1e8), Breaks(kMemoryCheck));
#endif
  EXPECT_THAT(CheckMemory(1e8, 1e8 + kMemoryOfAnyAnswer), IsEmpty());
}

TEST(Checks, ARefusalNeedsFieldValueAndRange) {
  const auto check = [](const char* field, const char* description) {
    return CheckRefusal(QuestionWithASmallRho(), {{field, description}});
  };
  EXPECT_THAT(check("spec.grid.rho[0]", "rho is 0.4; permitted: (1/2, 1/sqrt(2))"), IsEmpty());
  EXPECT_THAT(check("spec.grid.rho[1]", "rho is 0.4; permitted: (1/2, 1/sqrt(2))"),
              Breaks(kRefusalCheck));
  EXPECT_THAT(check("spec.grid.radius[0]", "rho is 0.4; permitted: (1/2, 1/sqrt(2))"),
              Breaks(kRefusalCheck));
  EXPECT_THAT(check("spec.grid.rho[0]", "rho is wrong; permitted: (1/2, 1/sqrt(2))"),
              Breaks(kRefusalCheck));
  EXPECT_THAT(check("spec.grid.rho[0]", "rho is 0.4"), Breaks(kRefusalCheck));
}

TEST(Checks, ADifferenceBeyondTheErrorsIsFound) {
  const auto with = [](const std::string& estimate) { return ResultWith(estimate); };
  const v1::PointResult ten = with("standard_error: 0.1");
  EXPECT_THAT(Disagreements({ten, with("value: 10.7 standard_error: 0.1")}), IsEmpty());
  EXPECT_THAT(Disagreements({ten, with("value: 10.8 standard_error: 0.1")}),
              Breaks(kAgreementCheck));
  EXPECT_THAT(Disagreements({ten, with("value: 10.8 standard_error: 0.1 model_error: 0.2")}),
              IsEmpty());
  EXPECT_THAT(Disagreements({with("standard_error: 0.1 exact: 10.6")}), Breaks(kAgreementCheck));

  v1::PointResult unknown = with("value: 20 standard_error: 0.1");
  unknown.mutable_estimates(0)->clear_model_error();
  EXPECT_THAT(Disagreements({ten, unknown}), IsEmpty());
}

// ---- question.h ----

TEST(Question, PrintsItselfAsACommandThatReadsItBack) {
  const auto spec = FromText<v1::EnsembleSpec>(
      "experiment: GAS_CONDUCTION"
      " grid { rho: inf delta: 1e-13 cells: '2x3' hot: 2 cold: 1 }"
      " target { collisions: 1000 } model: BILLIARD_REFERENCE");
  const std::string command = Command(spec), before = "ballpiston run --spec - <<<'";
  ASSERT_THAT(command, StartsWith(before));
  const std::string json = command.substr(before.size(), command.size() - before.size() - 1);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec read, client::ParseSpec("FILE", json));
  EXPECT_EQ(read.ShortDebugString(), spec.ShortDebugString());
}

constexpr double kMostSeconds = 0.01;

TEST(Draw, GivesTheSameQuestionAgain) {
  for (uint64_t number = 0; number < 20; ++number) {
    EXPECT_EQ(Draw(3, number, kMostSeconds).spec.SerializeAsString(),
              Draw(3, number, kMostSeconds).spec.SerializeAsString());
  }
  EXPECT_NE(Draw(3, 0, kMostSeconds).spec.SerializeAsString(),
            Draw(4, 0, kMostSeconds).spec.SerializeAsString());
}

// 12 of 300 questions are fewer than half of the expected number of each experiment.
TEST(Draw, AsksEveryExperimentByEveryModelWithEveryTarget) {
  std::map<int, int> experiments, models, targets, precisions;
  int permitted = 0;
  for (uint64_t number = 0; number < 300; ++number) {
    const Question question = Draw(1, number, kMostSeconds);
    if (!question.defect.empty()) continue;
    ++experiments[question.spec.experiment()];
    ++models[question.spec.model()];
    ++targets[question.spec.target().kind_case()];
    ++precisions[question.spec.precision()];
    permitted += server::CheckSpec(question.spec).violations.empty();
  }
  EXPECT_EQ(experiments.size(), std::size(kAllExperiments));
  EXPECT_EQ(models.size(), 6);
  EXPECT_EQ(targets.size(), 4);
  EXPECT_EQ(precisions.size(), 2);
  for (const auto& [experiment, count] : experiments) EXPECT_GT(count, 12) << experiment;
  EXPECT_GT(permitted, 150);
}

// ---- child processes of engine.h ----

TEST(Child, ReturnsTheReport) {
  const Report report = InChild([] {
    return Report{.outcome = "answered", .findings = {{"finite", "a value\tis\nnan"}}};
  });
  EXPECT_EQ(report.outcome, "answered");
  ASSERT_EQ(report.findings.size(), 1);
  EXPECT_EQ(report.findings[0].check, "finite");
  EXPECT_EQ(report.findings[0].what, "a value\tis\nnan");
}

TEST(Child, ReportsADeath) {
  const Report killed = InChild([]() -> Report {
    raise(SIGKILL);
    return {};
  });
  EXPECT_EQ(killed.outcome, "died");
  EXPECT_TRUE(killed.Breaks(kCrashCheck));
  EXPECT_FALSE(killed.Breaks(kEndCheck));
  const Report late = InChild([]() -> Report {
    raise(SIGXCPU);  // as the kernel does when the time is used up
    return {};
  });
  EXPECT_TRUE(late.Breaks(kEndCheck));
}

}  // namespace
}  // namespace ballpiston::questions
