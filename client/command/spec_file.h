// A specification from a file of proto JSON (ballpiston.v1.EnsembleSpec). --spec reads it.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// INVALID_ARGUMENT, with the file's name and the parser's message, if the text is not JSON, or has
// a field that a specification does not have.
absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, const std::string& json);

}  // namespace ballpiston::client
