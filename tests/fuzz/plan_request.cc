// PlanEnsembleJob: the ladder of an accepted specification, with no pilot run yet.
#include <cmath>
#include <optional>

#include "ballpiston/v1/ensemble.pb.h"
#include "core/model_choice/ladder.h"
#include "server/convert/plan.h"
#include "server/convert/spec.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

// Planning takes longer than all else that is done with a request.
constexpr size_t kMostPoints = 16;

bool IsSize(const std::optional<double>& x) { return !x || (std::isfinite(*x) && *x >= 0); }

void RequirePlanned(const EnsembleSpec& spec, size_t index) {
  const PointParameters point = PointAt(spec, index);
  Ladder ladder =
      LadderFor(spec, point, Machine(), [](const PilotPlace&) { return std::optional<Pilot>(); });
  ladder.DropPilot();
  Require(ladder.Chosen().answers, "the chosen model answers");
  const v1::PointPlan plan = server::PointPlanMessage(point, ladder);
  for (const Rung& rung : ladder.rungs) {
    Require(IsSize(rung.samples) && IsSize(rung.work), "samples and work are sizes");
    Require(IsSize(rung.statistical_error) && IsSize(rung.model_error), "errors are sizes");
    Require(!rung.reason.empty(), "a rung has a reason");
  }
  Require(plan.models_size() == static_cast<int>(ladder.rungs.size()), "every rung is told");
}

void CheckPlanRequest(const std::string& bytes) {
  v1::PlanEnsembleJobRequest request;
  if (!request.ParseFromString(bytes)) return;
  const server::CheckedSpec checked = server::CheckSpec(request.spec());
  if (!checked.violations.empty() || PointCount(checked.spec) > kMostPoints) return;
  RequirePlanned(checked.spec, PointCount(checked.spec) - 1);
}

const Registration kPlanRequest({.name = "plan_request",
                                 .check = CheckPlanRequest,
                                 .message = &v1::PlanEnsembleJobRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
