// Checks whether a store is sound: first SQLite's check of every page and index, then our check of
// the rows.
//
// The check uses a read-only connection in one transaction, also while a server uses the store. The
// store's log grows during the check. The first part takes about a second per gigabyte.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace ballpiston::server {

inline constexpr size_t kMaxProblems = 100;

struct StoreSummary {
  int64_t version = 0;
  int64_t bytes = 0;                    // on disk, the log included
  std::map<std::string, int64_t> jobs;  // by state
  int64_t results = 0;
  int64_t checkpoints = 0;
  std::vector<std::string> problems;  // one sentence each; the first kMaxProblems
  int64_t problem_count = 0;

  bool sound() const { return problem_count == 0; }
};

// The checks: states and times are consistent; specifications, results, checkpoints and errors can
// be read; every result and checkpoint belongs to a point of a job; an ended job has the number of
// results that it states, and a job that succeeded has all results; no ended job and no finished
// point has a checkpoint.
//   NOT_FOUND            no such file
//   FAILED_PRECONDITION  not a ballpiston store, newer, or too damaged to be opened
absl::StatusOr<StoreSummary> CheckStore(const std::string& path);

// Some lines of text for people, without a newline after the last.
std::string SummaryText(const StoreSummary& summary);

}  // namespace ballpiston::server
