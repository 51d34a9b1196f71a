// Reads the output of squeue: the job arrays in the queue, and the states of their tasks.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "absl/strings/string_view.h"

namespace ballpiston::server {

// The tasks of one array that have not ended.
struct QueuedArray {
  std::string id;            // Slurm's number of the array, which it may give out again
  std::set<size_t> waiting;  // indices
  std::set<size_t> running;
  std::set<std::string> reasons;  // why tasks wait
};

inline constexpr absl::string_view kQueueFormat = "%F|%K|%j|%T|%r";

// The lines of `squeue --noheader --format=kQueueFormat`, by name of the array; names without the
// prefix and lines that cannot be read are left out. An array whose tasks have all ended has no
// entry.
std::map<std::string, QueuedArray> ParseQueue(absl::string_view lines, absl::string_view prefix);

// "0-3,7,10-20:5%2" as indices; those above `most` are left out.
std::set<size_t> ParseIndices(absl::string_view text, size_t most);
// The shortest such text, without a step.
std::string IndicesText(const std::set<size_t>& indices);

// Whether a task that waits for this reason will not start unless an operator changes something.
bool WaitsForever(absl::string_view reason);

}  // namespace ballpiston::server
