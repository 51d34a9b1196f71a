// The SQL about computed data: checkpoints and chunks of unfinished points, and results of finished
// ones. Each function runs inside the transaction of its caller, which handles errors (sqlite.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

// Stores the checkpoint of an unfinished point and replaces the previous one. Drops the chunks
// before `chunk`, which are part of the checkpoint.
void WriteCheckpoint(Database& database, int64_t job, int64_t point, int64_t chunk,
                     const std::string& record);

// Empty if the point has no checkpoint.
std::optional<std::string> ReadCheckpoint(Database& database, int64_t job, int64_t point);

// Stores a chunk that waits for an earlier one. The first writer wins.
void InsertChunk(Database& database, int64_t job, int64_t point, int64_t chunk,
                 const std::string& record);

// The records of the point's waiting chunks, in order.
std::vector<std::string> ReadChunks(Database& database, int64_t job, int64_t point);

// Where a finished point ended: another job can continue it from there.
struct PointEnd {
  int32_t model = 0;  // that answered
  std::string state;  // a compressed storage.Checkpoint; empty: the point cannot be continued
};

// The bytes that a row of the table `results` takes in addition to its values. They include the
// row's entries in the indices.
inline constexpr size_t kResultRow = 60;

struct PointRow {
  int64_t point = 0;
  double samples = 0;
  std::string result;  // serialized v1::PointResult without the details
  // The same of the details, compressed; empty if there are none or not read.
  std::string details = {};
  bool has_checkpoint = true;  // may have a checkpoint or chunks
  PointEnd end = {};           // not read with the results

  size_t bytes() const { return kResultRow + result.size() + details.size() + end.state.size(); }
};

// Stores a point's result and drops its checkpoint and chunks. The first writer wins. Returns the
// number of the result among the job's results, 1, 2, 3, ... in the order of storing; 0 if the
// point already had a result.
int64_t InsertResult(Database& database, int64_t job, const PointRow& row);

// Empty if the point is not finished or cannot be continued.
std::optional<PointEnd> ReadEnd(Database& database, int64_t job, int64_t point);

enum class Details { kLeftOut, kIncluded };

// Reads results in grid order, from point `first`. Ends when `on_row` returns false.
void ReadResults(Database& database, int64_t job, int64_t first, Details details,
                 absl::FunctionRef<bool(PointRow row)> on_row);

// Reads the results after number `after`, in the order of storing. Ends when `on_result` returns
// false.
void ReadResultsStoredAfter(Database& database, int64_t job, int64_t after,
                            absl::FunctionRef<bool(int64_t number, std::string result)> on_result);

// The number of the job's last result is their count.
int64_t CountResults(Database& database, int64_t job);

struct PointSize {
  int64_t point = 0;
  double samples = 0;
  int64_t bytes = 0;  // PointRow::bytes
};

// All finished points, in grid order.
std::vector<PointSize> ListFinishedPoints(Database& database, int64_t job);

}  // namespace ballpiston::server
