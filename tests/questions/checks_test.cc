// Each check finds a planted failure, and nothing in a good answer.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "gmock/gmock.h"
#include "tests/questions/agreement_check.h"
#include "tests/questions/answer_check.h"
#include "tests/questions/finite_check.h"
#include "tests/questions/memory_check.h"
#include "tests/questions/plan_check.h"
#include "tests/questions/refusal_check.h"

namespace ballpiston::questions {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

auto Breaks(const char* check) { return ElementsAre(Field(&Finding::check, check)); }

v1::EnsembleSpec QuestionWithASmallRho() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->add_rho(0.4);
  spec.mutable_grid()->add_delta(0.1);
  return spec;
}

v1::PointResult GoodResult() {
  v1::PointResult result;
  result.set_model(v1::EnsembleSpec::BILLIARD);
  result.set_samples(1000);
  v1::Estimate& estimate = *result.add_estimates();
  estimate.set_name("mean_hit_time");
  estimate.set_value(10);
  estimate.set_standard_error(0.1);
  estimate.set_model_error(0);
  return result;
}

TEST(Checks, AGoodAnswerPasses) {
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), GoodResult()), IsEmpty());
}

TEST(Checks, EveryDefectOfAnAnswerIsFound) {
  v1::PointResult result = GoodResult();
  result.mutable_estimates(0)->set_exact(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kFiniteCheck));

  for (const double error : {0.0, 1e-17}) {
    result = GoodResult();
    result.mutable_estimates(0)->set_standard_error(error);
    EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kFalseZeroCheck)) << error;
  }

  result = GoodResult();
  result.mutable_estimates(0)->clear_standard_error();
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kMeasuredCheck));
  result.add_remarks("too few returns");
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), IsEmpty());

  result = GoodResult();
  result.set_samples(0);
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kMeasuredCheck));

  result = GoodResult();
  result.mutable_health()->set_escapes(1);
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kHealthCheck));

  result = GoodResult();
  result.add_histograms()->add_expected_probabilities(1 - 1e-5);
  EXPECT_THAT(CheckAnswer(QuestionWithASmallRho(), result), Breaks(kLawCheck));
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
  v1::PointPlan good;
  good.set_model(v1::EnsembleSpec::BILLIARD);
  v1::ModelPlan& model = *good.add_models();
  model.set_model(v1::EnsembleSpec::BILLIARD);
  model.set_answers(true);
  model.set_samples(64);
  model.set_work(0.1);
  EXPECT_THAT(CheckPlan(good), IsEmpty());

  v1::PointPlan plan = good;
  plan.mutable_models(0)->set_samples(0);
  EXPECT_THAT(CheckPlan(plan), Breaks(kPlanCheck));
  plan = good;
  plan.mutable_models(0)->clear_work();
  EXPECT_THAT(CheckPlan(plan), Breaks(kPlanCheck));
  plan = good;
  plan.mutable_models(0)->set_work(1e115);
  EXPECT_THAT(CheckPlan(plan), Breaks(kPlanCheck));
  plan = good;
  plan.set_model(v1::EnsembleSpec::MARKOV);
  EXPECT_THAT(CheckPlan(plan), Breaks(kPlanCheck));
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
  const auto with = [](double value, double error, double model_error) {
    v1::PointResult result = GoodResult();
    result.mutable_estimates(0)->set_value(value);
    result.mutable_estimates(0)->set_standard_error(error);
    result.mutable_estimates(0)->set_model_error(model_error);
    return result;
  };
  EXPECT_THAT(Disagreements({with(10, 0.1, 0), with(10.7, 0.1, 0)}), IsEmpty());
  EXPECT_THAT(Disagreements({with(10, 0.1, 0), with(10.8, 0.1, 0)}), Breaks(kAgreementCheck));
  EXPECT_THAT(Disagreements({with(10, 0.1, 0), with(10.8, 0.1, 0.2)}), IsEmpty());

  v1::PointResult unknown = with(20, 0.1, 0);
  unknown.mutable_estimates(0)->clear_model_error();
  EXPECT_THAT(Disagreements({with(10, 0.1, 0), unknown}), IsEmpty());

  v1::PointResult wrong = with(10, 0.1, 0);
  wrong.mutable_estimates(0)->set_exact(10.6);
  EXPECT_THAT(Disagreements({wrong}), Breaks(kAgreementCheck));
}

}  // namespace
}  // namespace ballpiston::questions
