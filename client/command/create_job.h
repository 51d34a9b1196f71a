// Submitting a job over a connection, and what is told of it: that its answer was there already, or
// what to do about a limit of the server.
#ifndef BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
#define BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/library/ensemble_client.h"

namespace CLI {
class App;
}

namespace ballpiston::client {

// How a job is asked for, besides its specification.
struct JobFlags {
  bool fresh = false;
  std::optional<std::string> priority;
  std::optional<std::string> request_id;

  void AddTo(CLI::App& verb);
};

// INVALID_ARGUMENT if the priority is no whole number (whether it is permitted is the server's to
// say), or the request id no UUID.
absl::StatusOr<CreateOptions> OptionsOf(const JobFlags& flags);

// With one id for both attempts (Connection::Ask): a private server that took the job and was gone
// before it could answer does not get a second one.
//   RESOURCE_EXHAUSTED  with a second line that says what can be done
absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                          const v1::EnsembleSpec& spec, CreateOptions options = {});

// Of a job with answered_from_store:
//   answered from the store: ensembleJobs/ID, computed 2026-11-21 12:00 UTC (--fresh computes anew)
std::string FromStoreText(const v1::EnsembleJob& job);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
