// Submits a job over a connection.
#ifndef BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
#define BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_

#include "absl/status/statusor.h"
#include "client/command/connection.h"
#include "client/library/ensemble_client.h"
#include "client/library/request_id.h"

namespace ballpiston::client {

// One id for both attempts: a private server that took the job and was gone before it could answer
// does not get a second one.
inline absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                                 const v1::EnsembleSpec& spec) {
  const EnsembleClient client(connection.channel);
  return connection.Ask([&, id = NewRequestId()] { return client.Create(spec, id); });
}

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CREATE_JOB_H_
