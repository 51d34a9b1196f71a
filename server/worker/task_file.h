// The tasks of a job array: the server writes one file, and each task reads its leases from it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/worker/lease_record.h"

namespace ballpiston::server {

// One task of an array.
struct ArrayTask {
  std::string array = {};  // the array's unique name
  size_t task = 0;         // index in the array
  std::vector<IdentifiedLease> leases = {};
};

// Writes the tasks of an array, in the order of their indices. Errors are those of
// WriteCheckedFile.
absl::Status WriteTaskFile(const std::string& path, const std::string& array,
                           const std::vector<std::vector<IdentifiedLease>>& tasks);

// Errors, besides those of ReadCheckedFile: INVALID_ARGUMENT if the file has no such task;
// UNIMPLEMENTED if a lease is of another engine version; DATA_LOSS if a lease is damaged.
absl::StatusOr<ArrayTask> ReadTask(const std::string& path, size_t task);

// The leases of all tasks, by the task's index. Errors as ReadTask.
absl::StatusOr<std::vector<std::vector<IdentifiedLease>>> ReadTasks(const std::string& path);

}  // namespace ballpiston::server
