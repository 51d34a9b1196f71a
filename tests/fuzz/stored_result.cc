// A finished point's result or its details, as pages of results and a restart read them.
#include "core/ensemble/point_experiment.h"
#include "core/experiment/all_experiments.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

// As ReadShortfall does.
void CheckShortfall(const v1::PointResult& result, const std::string& bytes) {
  constexpr double kTolerance = 0.01;
  const EnsembleSpec spec = {.target = {.tolerance = kTolerance, .budget_seconds = 1.0}};
  const Estimate reached = server::FirstEstimateOf(result);
  if (MeetsTolerance(reached, kTolerance)) return;
  RequireSendable(server::ToleranceNotReached(spec, 0, reached), bytes);
}

void CheckStoredResult(const std::string& bytes) {
  const absl::StatusOr<v1::PointResult> details = server::DetailsFromBytes(bytes);
  Require(details.ok() || absl::IsDataLoss(details.status()), "damage of details is DATA_LOSS");
  const absl::StatusOr<v1::PointResult> result = server::ResultFromBytes(bytes);
  if (!result.ok()) return Require(absl::IsDataLoss(result.status()), "damage is DATA_LOSS");
  const std::string stored = server::DeterministicBytes(*result);
  const absl::StatusOr<v1::PointResult> again = server::ResultFromBytes(stored);
  Require(again.ok() && server::DeterministicBytes(*again) == stored,
          "reading a stored result gives the message that was stored");
  CheckShortfall(*result, bytes);
  const v1::PointResult told = server::WithDetails({}, *result, kEquilibrium);
  Require(told.histograms_size() == result->histograms_size(), "clients get every histogram");
}

const Registration kStoredResult({.name = "stored_result",
                                  .check = CheckStoredResult,
                                  .message = &v1::PointResult::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
