// The SQL about pilot runs: the measured error of the limit at each place. Each function runs
// inside the transaction of its caller. Errors are those of sqlite.h.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/model_choice/limit_error.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

absl::Status InsertPilot(Database& database, const std::string& engine_version,
                         const PilotPlace& place, const Pilot& pilot);

absl::StatusOr<std::optional<Pilot>> FindPilot(Database& database,
                                               const std::string& engine_version,
                                               const PilotPlace& place);

}  // namespace ballpiston::server
