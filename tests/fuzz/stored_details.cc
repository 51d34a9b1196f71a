// The details of a finished point's result: read for pages of results.
#include "core/experiment/all_experiments.h"
#include "server/convert/point_result.h"
#include "server/convert/result_record.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckStoredDetails(const std::string& bytes) {
  const absl::StatusOr<storage::Details> details = server::DetailsFromBytes(bytes);
  if (!details.ok()) return Require(absl::IsDataLoss(details.status()), "damage is DATA_LOSS");
  const std::string stored = server::RecordBytes(*details);
  const absl::StatusOr<storage::Details> again = server::DetailsFromBytes(stored);
  Require(again.ok() && server::RecordBytes(*again) == stored, "stored bytes come back");
  const v1::PointResult told = server::PointResultMessage({}, *details, kEquilibrium);
  Require(told.histograms_size() == details->histograms_size(), "they can be told");
}

const Registration kStoredDetails({.name = "stored_details",
                                   .check = CheckStoredDetails,
                                   .message = &storage::Details::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
