// The SQL about pilot runs: the measured error of the limit at each place. Each function runs
// inside the transaction of its caller, which handles errors (sqlite.h).
#pragma once

#include <optional>
#include <string>

#include "core/model_choice/limit_error.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

void InsertPilot(Database& database, const std::string& engine_version, const PilotPlace& place,
                 const Pilot& pilot);

std::optional<Pilot> FindPilot(Database& database, const std::string& engine_version,
                               const PilotPlace& place);

}  // namespace ballpiston::server
