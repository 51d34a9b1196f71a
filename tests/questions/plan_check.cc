#include "tests/questions/checks.h"

namespace ballpiston::questions {
namespace {

bool TakesSamples(v1::EnsembleSpec::Model model) {
  return model != v1::EnsembleSpec::CLOSED_FORM && model != v1::EnsembleSpec::SPECTRUM;
}

}  // namespace

const v1::ModelPlan* Chosen(const v1::PointPlan& plan) {
  for (const v1::ModelPlan& model : plan.models()) {
    if (model.model() == plan.model() && model.answers()) return &model;
  }
  return nullptr;
}

Findings CheckPlan(const v1::PointPlan& plan) {
  Findings findings = CheckFinite(plan);
  const auto add = [&](const auto&... what) {
    findings.push_back({kPlanCheck, absl::StrCat(what...)});
  };
  for (const v1::ModelPlan& model : plan.models()) {
    if (model.samples() < 0 || model.work() < 0 || model.relative_statistical_error() < 0 ||
        model.relative_model_error() < 0) {
      add("a number is negative: ", model.ShortDebugString());
    }
  }
  const v1::ModelPlan* const chosen = Chosen(plan);
  if (chosen == nullptr) {
    add("no model answers");
    return findings;
  }
  if (!chosen->has_samples() || (TakesSamples(chosen->model()) && chosen->samples() < 1)) {
    add("no samples are planned: ", chosen->ShortDebugString());
  }
  if (!chosen->has_work() || chosen->work() > kMostPlannedSeconds) {
    add("no machine can compute what is planned: ", chosen->ShortDebugString());
  }
  return findings;
}

}  // namespace ballpiston::questions
