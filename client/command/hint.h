// What a user can do about an error: a second line of its message.
#ifndef BALLPISTON_CLIENT_COMMAND_HINT_H_
#define BALLPISTON_CLIENT_COMMAND_HINT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/command/connection.h"

namespace ballpiston::client {

// The same error, details included, with the hint on a line of its own.
absl::Status WithHint(const absl::Status& status, absl::string_view hint);

// If the results of the job have expired, the hint is the command that computes them again. Any
// other status stays as it is.
absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_HINT_H_
