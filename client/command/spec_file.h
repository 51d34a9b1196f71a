// A specification from a file of proto JSON (ballpiston.v1.EnsembleSpec).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// `-` is standard input. INVALID_ARGUMENT, with the file's name and the parser's message, if the
// file cannot be read, is not JSON, or has a field that a specification does not have.
absl::StatusOr<v1::EnsembleSpec> ReadSpecFile(const std::string& path);

// `name` stands for the file in errors.
absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, const std::string& json);

}  // namespace ballpiston::client
