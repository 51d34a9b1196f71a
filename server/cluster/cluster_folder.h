// The folder that the server shares with workers (worker/shared_files.h), before work is laid into
// it. Besides the leases it has
//
//   owner               the identity of the server that uses the folder
//   log/                what workers say that Slurm starts
//   ballpiston-worker   a copy of the program
//
// Mode 0700. Errors name the folder.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::server {

// Makes the folder's contents, except the program. FAILED_PRECONDITION unless `folder` is an
// absolute path of a folder that belongs to this user, that other users cannot write, and that no
// other server uses; UNAVAILABLE if it cannot be used now; RESOURCE_EXHAUSTED if the disk is full.
absl::Status PrepareFolder(const std::string& folder, const std::string& identity);

// Copies the program into the folder, unless there is a copy with the same bytes. `worker` empty:
// the program that is installed with this server. Workers that run keep the program that they have;
// on NFS some may end by SIGBUS.
absl::Status CopyWorker(const std::string& folder, const std::string& worker);

}  // namespace ballpiston::server
