// The server and the jobs that a verb uses. The verb uses the server of --server, otherwise the
// server of BALLPISTON_SERVER or of the config file, otherwise the private server
// (library/local_server.h).
//
// A Unix socket, such as the private server's, uses neither TLS nor tokens. Flags of TLS and tokens
// are then an error; the same settings in the environment and the config file are ignored.
#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/command/options.h"
#include "client/command/verbs.h"
#include "client/library/client.h"

namespace ballpiston::client {

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  Client client;             // over the channel; starts a private server again
  std::string flags;         // for hints: " --server ADDRESS ..." if given
  ChannelSecurity security;  // of the channel
};

// INVALID_ARGUMENT if flags of TLS or of a token are given for a server that does not use them: the
// private server, or one at a Unix socket. Opens no file and makes no call.
absl::Status CheckServerFlags(const Options& options);

// Adds the server's address to an error of the connection. Does not change the server's own errors.
absl::Status NameServer(const absl::Status& status, const Connection& connection);

// Advice for a failed connection, on a line of its own: the messages of gRPC 1.51 and OpenSSL 3
// describe the failure, but do not say what the user can do. Empty if the text is unknown.
std::string ConnectionHint(const std::string& address, const ChannelSecurity& security,
                           absl::string_view message);

// If the results of the job have expired, adds a line with the command that computes them again.
// Returns any other status unchanged.
absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job);

using VerbOfServer = std::function<VerbResult(const Connection&)>;

// Connects and runs `verb`. If the server does not answer, the error names the server. Without
// `may_start`, for a verb that only shows the state of a server, no private server is started.
VerbResult WithServer(const Options& options, const Terminal& terminal, const VerbOfServer& verb,
                      bool may_start = true);

using JobStates = std::vector<v1::EnsembleJob::State>;

inline const JobStates kActiveStates = {v1::EnsembleJob::QUEUED, v1::EnsembleJob::RUNNING,
                                        v1::EnsembleJob::CANCELLING};
inline const JobStates kEndedStates = {v1::EnsembleJob::SUCCEEDED, v1::EnsembleJob::FAILED,
                                       v1::EnsembleJob::CANCELLED};

using VerbOfJobs =
    std::function<VerbResult(const Connection&, const std::vector<v1::EnsembleJob>&)>;

// Connects and runs `verb` with jobs. These are the named jobs (only `name` is set) or, with
// --label, the jobs that have all these labels and one of `states` (empty: any state), newest
// first. INVALID_ARGUMENT if there are neither names nor labels, or both. NOT_FOUND if no job has
// the labels.
VerbResult WithJobs(const Options& options, const Terminal& terminal, const JobStates& states,
                    const VerbOfJobs& verb);

}  // namespace ballpiston::client
