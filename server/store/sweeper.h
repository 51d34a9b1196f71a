// Frees the space of the results of deleted and expired jobs: removes their rows, then shortens the
// file by its free pages. Its transactions are short, so that other writes need not wait long. Such
// a job is in the table `dropped` until its last row is removed, so a restart goes on with the
// rest.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

class Sweeper {
 public:
  // One transaction of some 20 ms. False: nothing was left to do.
  absl::StatusOr<bool> Step(Database& database);

 private:
  absl::StatusOr<bool> DropRows(Database& database);
  absl::StatusOr<bool> ShortenFile(Database& database);

  static constexpr int64_t kFirstRows = 64, kFirstPages = 64;

  int64_t job_ = 0;  // the last step removed rows of this job
  // Rows to remove in one step, adapted to the time of earlier steps. Starts again for another job,
  // whose rows may be larger.
  int64_t rows_ = kFirstRows;
  int64_t pages_ = kFirstPages;
};

}  // namespace ballpiston::server
