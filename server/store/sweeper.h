// Frees the space of the results of deleted and expired jobs: removes their rows, then shortens the
// file by its free pages. Its transactions are short, so that other writes need not wait long. Such
// a job is in the table `dropped` until its last row is removed, so a restart goes on with the
// rest.
#ifndef BALLPISTON_SERVER_STORE_SWEEPER_H_
#define BALLPISTON_SERVER_STORE_SWEEPER_H_

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

  // What one step removes; adapted to the time that steps take.
  int64_t rows_ = 64;
  int64_t pages_ = 64;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_SWEEPER_H_
