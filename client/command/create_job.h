// Submits a job over a connection, and makes two messages: that the results were already stored,
// and what the user can do about a limit of the server.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

// A retry (library/client.h) uses the same request id: if a private server stored the job and
// stopped before it answered, the retry returns that job. If the user interrupts the call, a
// message shows the id. With --resume the id is derived from the specification and the engine's
// version.
//   RESOURCE_EXHAUSTED  with a second line that advises the user
absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                          const v1::EnsembleSpec& spec, const Options& options,
                                          const Terminal& terminal);

// The note for a job that uses what is stored, else empty:
//   answered from the store: NAME, computed 2026-11-21 12:00 UTC (--fresh computes it again)
//   continues NAME: 100000 samples are in the store (--fresh computes them again)
std::string ReusedText(const v1::EnsembleJob& job);

}  // namespace ballpiston::client
