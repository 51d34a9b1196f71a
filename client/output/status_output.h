// Prints a server's status: a table, or the message as JSON.
#pragma once

#include <ostream>

#include "absl/time/time.h"
#include "ballpiston/v1/server.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// The table shows the time since the server's start, counted from `now`. Every other format is
// JSON.
void PrintStatus(const v1::ServerStatus& status, absl::Time now, Format format, std::ostream& out);

}  // namespace ballpiston::client
