// Prints what a server says of itself: a table, or the message as JSON.
#ifndef BALLPISTON_CLIENT_OUTPUT_STATUS_OUTPUT_H_
#define BALLPISTON_CLIENT_OUTPUT_STATUS_OUTPUT_H_

#include <ostream>

#include "absl/time/time.h"
#include "ballpiston/v1/server.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// `now` is for how long it has been up. Any format but a table is JSON.
void PrintStatus(const v1::ServerStatus& status, absl::Time now, Format format, std::ostream& out);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_STATUS_OUTPUT_H_
