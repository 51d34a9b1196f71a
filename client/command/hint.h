// Hints: a second line of an error message tells the user what to do.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/command/connection.h"

namespace ballpiston::client {

// The same error with the same details, and the hint on a separate line.
absl::Status WithHint(const absl::Status& status, absl::string_view hint);

// If the results of the job have expired, adds the command that computes them again. Returns any
// other status unchanged.
absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job);

}  // namespace ballpiston::client
