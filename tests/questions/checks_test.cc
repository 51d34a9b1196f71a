// Each check finds a planted failure, and nothing in a good answer.
#include "tests/questions/checks.h"

#include "tests/support/message_text.h"

namespace ballpiston::questions {
namespace {

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

}  // namespace
}  // namespace ballpiston::questions
