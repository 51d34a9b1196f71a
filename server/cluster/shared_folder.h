// The server's part of the folder that it shares with the machines of a cluster.
//
//   SHARED/IDENTITY/                  of one server; mode 0700
//     ballpiston-worker-HASH          a copy of the worker
//     NAME/                           one folder for each job array
//       tasks                         its tasks (worker/task_file.h)
//       task-TASK.SEQUENCE.chunks     what its tasks computed (worker/chunk_file.h)
//       task-TASK.lease-LEASE.crash   the engine killed this task (worker/crash_mark.h)
//       TASK.log                      what a task said
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::server {

std::string TaskFileIn(const std::string& array_folder);

class SharedFolder {
 public:
  // `identity` names the server among all that use the folder.
  SharedFolder(std::string folder, std::string identity);

  // Makes the server's own folder if there is none. FAILED_PRECONDITION unless SHARED is an
  // absolute path of a folder that belongs to this user and that other users cannot write;
  // UNAVAILABLE if it cannot be used now. Errors name the folder.
  absl::Status Prepare() const;

  // Copies the program, unless there is a copy with the same bytes. Returns the copy's path.
  absl::StatusOr<std::string> CopyWorker(const std::string& program) const;

  std::string PathOf(const std::string& array) const;

  // RESOURCE_EXHAUSTED if the disk is full.
  absl::Status MakeArray(const std::string& array) const;
  void RemoveArray(const std::string& array) const;  // as far as possible
  absl::StatusOr<std::vector<std::string>> ListArrays(const std::string& prefix) const;

 private:
  const std::string shared_;
  const std::string own_;
};

}  // namespace ballpiston::server
