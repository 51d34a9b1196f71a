// The SQL about the usage of principals. Each function runs inside the transaction of its caller.
// UNAVAILABLE: SQLite failed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

struct StoredUsage {
  std::string principal;
  int64_t jobs = 0;
  int64_t bytes = 0;  // JobRecord::bytes of these
};

// Of all principals with jobs.
absl::StatusOr<std::vector<StoredUsage>> ReadStoredUsage(Database& database);

// Processor time of a principal's jobs on one day.
struct DayOfWork {
  std::string principal;
  int64_t day = 0;  // since 1970-01-01, UTC
  double seconds = 0;
};

absl::StatusOr<std::vector<DayOfWork>> ReadWork(Database& database, int64_t first_day);

// Adds to the stored time of the day.
absl::Status AddWork(Database& database, const DayOfWork& work);
absl::Status DropWorkBefore(Database& database, int64_t day);

// The bytes of the store's pages that are not free. The log beside the file is not counted.
absl::StatusOr<int64_t> UsedBytes(Database& database);

// Whether rows of deleted or expired jobs still have to be removed (sweeper.h).
absl::StatusOr<bool> IsSweeping(Database& database);

}  // namespace ballpiston::server
