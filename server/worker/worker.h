// The loop of a worker: it takes leases from a shared folder (shared_files.h), computes them, and
// leaves the chunks there, until there is nothing to do or it has to end.
//
// A worker knows that a lease is still its own because its file is there. If the server has taken
// the file away, the worker drops the lease at the next touch. A worker that has to end gives its
// lease back. Properties, each with a test of its name:
//   1. ChunksHaveTheBitsOfAWholePoint.  2. StopsAtTheTolerance.
//   3. LeasesContinueTheTrajectoriesOfASteadyState.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "server/processor_time.h"
#include "server/worker/lease_file.h"
#include "server/worker/shared_files.h"

namespace ballpiston::server {

// When the worker has to end.
enum class EndOfWork {
  kNotYet,
  kAfterChunk,  // with the chunk that it computes now
  kNow,         // the chunk is dropped
};

// The worker's machine. Tests have another.
struct WorkerHost {
  std::function<std::chrono::steady_clock::time_point()> now;
  // May return earlier when `end` changes.
  std::function<void(std::chrono::duration<double>)> sleep;
  std::function<uint64_t()> random_bits;
  std::function<double()> processor_seconds = ThreadSeconds;  // of the calling thread
  std::function<EndOfWork()> end;
  std::function<void(absl::string_view line)> report;  // one line for people, without its end
  // The worker begins to compute a lease: if the engine kills the worker, this file is to be moved.
  std::function<void(const std::string& from, const std::string& to)> lease_begins;
  LeaseReader read_lease = TakeLease;
};

struct WorkerOptions {
  std::string name = {};     // unique among all workers; letters, digits, '-' and '_'
  double idle_seconds = 60;  // without a lease: the worker ends
  double retry_seconds = 5;  // between two attempts to use a folder that is full or not there
  // The longest time of these attempts for one operation on a lease; they end at once at kNow.
  double give_up_seconds = 120;
  // Bytes. A lease that needs more is given back: it would end the worker (MemoryOf).
  double memory = std::numeric_limits<double>::infinity();
};

// OK if there was nothing left to do, or the worker had to end. UNIMPLEMENTED if a lease is of
// another engine version; the lease is there for other workers. Other errors: those of the folder.
absl::Status Work(SharedFiles& files, const WorkerOptions& options, const WorkerHost& host);

}  // namespace ballpiston::server
