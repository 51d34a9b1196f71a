#include "client/command/spec_file.h"

#include <google/protobuf/util/json_util.h>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

absl::Status BadFile(absl::string_view name, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat("--spec ", name, ": ", reason));
}

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
  // The parser would accept `null` or a bare string as an empty message.
  if (!absl::StartsWith(absl::StripLeadingAsciiWhitespace(json), "{")) {
    return BadFile(name, "not a JSON object");
  }
  v1::EnsembleSpec spec;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &spec);
  if (status.ok()) {
    DropSignsOfZeros(spec);
    return spec;
  }
  // The parser's message contains the whole wrong value, which may be long.
  return BadFile(name, Shortened(std::string(status.message()), kLongestMessage));
}

}  // namespace ballpiston::client
