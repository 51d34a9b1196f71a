// The mark that a task leaves in its array's folder if the engine kills it: an empty file whose
// name says which lease was being computed.
#pragma once

#include <cstddef>
#include <string>

namespace ballpiston::server {

// "FOLDER/task-TASK.lease-LEASE.crash"
std::string CrashMarkFile(const std::string& folder, size_t task, size_t lease);

// From now on this process computes the lease. One thread at a time.
void SetCrashMark(const std::string& folder, size_t task, size_t lease);

// Leaves the mark that was set last. Async-signal-safe.
void LeaveCrashMark(int signal);

}  // namespace ballpiston::server
