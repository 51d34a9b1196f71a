#include "client/command/spec_file.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

// The parser reads -0 as the integer 0, without a sign, but keeps the sign of -0.0. Without the
// sign a specification stays the same when it is printed and read again.
void DropSignsOfZeros(v1::EnsembleSpec& spec) {
  if (spec.target().has_tolerance()) {
    spec.mutable_target()->set_tolerance(spec.target().tolerance() + 0.0);
  }
  if (!spec.has_grid()) return;
  v1::Grid& grid = *spec.mutable_grid();
  for (auto* list :
       {grid.mutable_rho(), grid.mutable_delta(), grid.mutable_epsilon(), grid.mutable_exponent(),
        grid.mutable_temperature(), grid.mutable_hot(), grid.mutable_cold()}) {
    for (double& number : *list) number += 0.0;
  }
}

}  // namespace

absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, const std::string& json) {
  v1::EnsembleSpec spec;
  if (absl::Status bad = ReadJson(json, spec); !bad.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--spec ", name, ": ", bad.message()));
  }
  DropSignsOfZeros(spec);
  return spec;
}

}  // namespace ballpiston::client
