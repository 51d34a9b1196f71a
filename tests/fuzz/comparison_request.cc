// CompareMethods: what is looked at before the comparison begins.
#include "ballpiston/v1/method.pb.h"
#include "core/geometry/pair_geometry.h"
#include "server/convert/errors.h"
#include "server/convert/method.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void RequireRunnable(const MethodComparisonSpec& spec) {
  Require(PairGeometry::Create(spec.rho, spec.delta).ok(), "the pair exists");
  Require(spec.epsilon > 0 && spec.epsilon < 0.5, "both move");
  Require(spec.seconds_per_curve >= kMinSecondsPerCurve &&
              spec.seconds_per_curve <= kMaxSecondsPerCurve,
          "the time is within its limits");
  Require(spec.relaxation_deltas.size() <= kMaxRelaxationDeltas, "few deltas");
  for (const double delta : spec.relaxation_deltas) {
    Require(PairGeometry::Create(spec.rho, delta).ok(), "every pair exists");
  }
}

void CheckComparisonRequest(const std::string& bytes) {
  v1::CompareMethodsRequest request;
  if (!request.ParseFromString(bytes)) return;
  const server::CheckedComparison checked = server::CheckComparison(request);
  if (checked.violations.empty()) return RequireRunnable(checked.spec);
  RequireNamed(checked.violations, "");
  RequireSendable(server::InvalidRequest(checked.violations), bytes);
}

const Registration kComparisonRequest({.name = "comparison_request",
                                       .check = CheckComparisonRequest,
                                       .message = &v1::CompareMethodsRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
