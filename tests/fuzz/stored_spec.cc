// The specification in a job's row, as a restart reads it.
#include "server/convert/spec.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckStoredSpec(const std::string& bytes) {
  const absl::StatusOr<v1::EnsembleSpec> spec = server::SpecFromBytes({bytes});
  if (!spec.ok()) return Require(absl::IsDataLoss(spec.status()), "damage is DATA_LOSS");
  const server::StoredSpec stored = server::SpecBytes(*spec);
  const absl::StatusOr<v1::EnsembleSpec> again = server::SpecFromBytes(stored);
  Require(again.ok() && server::SpecBytes(*again) == stored, "stored bytes come back");
  RequireJudged(*spec, bytes);
}

const Registration kStoredSpec({.name = "stored_spec",
                                .check = CheckStoredSpec,
                                .message = &v1::EnsembleSpec::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
