#include "client/command/spec_file.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "client/output/json.h"

namespace ballpiston::client {

absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, const std::string& json) {
  v1::EnsembleSpec spec;
  const std::string text(absl::StripPrefix(json, "\xEF\xBB\xBF"));  // some programs' mark
  if (absl::Status bad = ReadJson(text, spec); !bad.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--spec ", name, ": ", bad.message()));
  }
  return spec;
}

}  // namespace ballpiston::client
