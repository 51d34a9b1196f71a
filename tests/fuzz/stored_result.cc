// A finished point's result, as pages of results and a restart read it.
#include "core/ensemble/point_experiment.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/result_record.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

// As ReadShortfall does.
void CheckShortfall(const storage::Result& result, const std::string& bytes) {
  constexpr double kTolerance = 0.01;
  const EnsembleSpec spec = {.target = {.tolerance = kTolerance, .budget_seconds = 1.0}};
  const Estimate reached = server::FirstEstimateOf(result);
  if (MeetsTolerance(reached, kTolerance)) return;
  RequireSendable(server::ToleranceNotReached(spec, 0, reached), bytes);
}

void CheckStoredResult(const std::string& bytes) {
  absl::StatusOr<storage::Result> result = server::ResultFromBytes(bytes);
  if (!result.ok()) return Require(absl::IsDataLoss(result.status()), "damage is DATA_LOSS");
  const std::string stored = server::RecordBytes(*result);
  const absl::StatusOr<storage::Result> again = server::ResultFromBytes(stored);
  Require(again.ok() && server::RecordBytes(*again) == stored, "stored bytes come back");
  CheckShortfall(*result, bytes);
  Require(server::PointResultMessage(*result).index() == static_cast<int32_t>(result->index()),
          "it can be told");
}

const Registration kStoredResult({.name = "stored_result",
                                  .check = CheckStoredResult,
                                  .message = &storage::Result::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
