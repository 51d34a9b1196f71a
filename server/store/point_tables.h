// The SQL about computed data: checkpoints and chunks of unfinished points, results of finished
// ones. Each function runs inside the transaction of its caller. Errors are those of sqlite.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

// Stores the checkpoint of an unfinished point and replaces the previous one. Drops the chunks
// before `chunk`, which are part of the checkpoint.
absl::Status WriteCheckpoint(Database& database, int64_t job, int64_t point, int64_t chunk,
                             const std::string& record);

// Empty if the point has no checkpoint.
absl::StatusOr<std::optional<std::string>> ReadCheckpoint(Database& database, int64_t job,
                                                          int64_t point);

// Stores a chunk that waits for an earlier one. The first writer wins.
absl::Status InsertChunk(Database& database, int64_t job, int64_t point, int64_t chunk,
                         const std::string& record);

// The records of the point's waiting chunks, in order.
absl::StatusOr<std::vector<std::string>> ReadChunks(Database& database, int64_t job, int64_t point);

struct PointRow {
  int64_t point = 0;
  double samples = 0;
  std::string result;  // serialized v1::PointResult without the details
  std::string details =
      {};  // the same of the details, compressed; empty if there are none or not read
  bool has_checkpoint = true;  // may have a checkpoint or chunks
};

// Stores a point's result and drops its checkpoint and chunks. The first writer wins. Returns the
// number of the result among the job's results, 1, 2, 3, ... in the order of storing; 0 if the
// point already had a result.
absl::StatusOr<int64_t> InsertResult(Database& database, int64_t job, const PointRow& row);

enum class Details { kLeftOut, kIncluded };

// Reads results in grid order, from point `first`. Ends when `on_row` returns false.
absl::Status ReadResults(Database& database, int64_t job, int64_t first, Details details,
                         const std::function<bool(PointRow row)>& on_row);

// Reads the results after number `after`, in the order of storing. Ends when `on_row` returns
// false.
absl::Status ReadResultsStoredAfter(
    Database& database, int64_t job, int64_t after,
    const std::function<bool(int64_t number, PointRow row)>& on_row);

// The number of the job's last result; 0 if there is none.
absl::StatusOr<int64_t> LastResultNumber(Database& database, int64_t job);

absl::StatusOr<int64_t> CountResults(Database& database, int64_t job);

// All finished points without their results, in grid order.
absl::StatusOr<std::vector<PointRow>> ListFinishedPoints(Database& database, int64_t job);

// The bytes of the job's results and details together.
absl::StatusOr<int64_t> BytesOfResults(Database& database, int64_t job);

}  // namespace ballpiston::server
