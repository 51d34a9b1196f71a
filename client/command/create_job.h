// Submitting a job over a connection, and what is told of it: that its answer was there already, or
// what to do about a limit of the server.
#ifndef BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
#define BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_

#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

// With one id for both attempts (Connection::Ask): a private server that took the job and was gone
// before it could answer does not get a second one. If the user interrupts it, a message shows the
// id. With --resume the id is derived from the question and the engine's version.
//   RESOURCE_EXHAUSTED  with a second line that says what can be done
absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                          const v1::EnsembleSpec& spec, const Options& options,
                                          const Terminal& terminal);

// Of a job with answered_from_store:
//   answered from the store: ensembleJobs/ID, computed 2026-11-21 12:00 UTC (--fresh computes anew)
std::string FromStoreText(const v1::EnsembleJob& job);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
