// The unit of work that an executor takes from the scheduler: chunks of one point.
//
// A lease says all that is needed to compute its chunks: a machine elsewhere gets it as a message
// (worker/lease_file.h). The results depend on the specification alone, so a chunk that was
// computed twice, or late, has the same bits.
//
// A lease may instead ask for points to be opened (Scheduler::Open). A point that needs no samples
// is finished when it is opened, so many cheap points are one lease.
//
// A local executor, the threads of this server, opens points, takes every lease, and shares a lease
// between turns. The scheduler waits for its turns to end before a run ends. An executor elsewhere
// gets only leases of chunks, and only of large runs (Run::IsLarge). It reports all chunks, or
// returns the lease, or keeps it until the lease's stop is requested. It may report chunks late,
// twice and in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Bytes, upper bounds: with one turn at a time, and for each further turn at the same time. What a
// turn takes is kept until the next turn (thread_executor.cc).
struct LeaseMemory {
  double of_one_turn = 0;
  double of_a_further_turn = 0;
};

// The work that the turns at one lease of a local executor share.
class SharedWork {
 public:
  virtual ~SharedWork() = default;

  // Whether another turn would find work. Called with the scheduler's lock held.
  virtual bool HasTurn() const = 0;
};

struct Lease {
  int64_t number = 0;  // greater than those before, in the scheduler's life
  int64_t run = 0;     // these two are RunRequest's key and generation
  int64_t generation = 0;
  bool local = true;  // as of Capacity
  int attempt = 1;    // greater than 1 if an executor returned some of the chunks
  int crashes = 0;    // earlier attempts that died of themselves (Scheduler::ReturnCrashed)

  std::shared_ptr<const EnsembleSpec> spec = {};  // of the run
  std::vector<size_t> opens = {};                 // points to open; empty: the lease has chunks

  size_t point = 0;  // of the run's grid
  std::shared_ptr<const PointExperiment> experiment = {};

  PartialChunk start = {};  // the first chunk, and what is merged of it already
  uint64_t end = 0;         // the chunk after the last
  // If samples continue each other: the states from which chunks start, by group.
  std::vector<GroupState> groups = {};
  double seconds = 0;       // predicted, of one core at nominal speed; 0 if all the rest is leased
  LeaseMemory memory = {};  // if the lease is local
  std::shared_ptr<SharedWork> work = {};  // if the lease is local and has chunks

  // Stop is requested when the chunks are no longer needed.
  std::stop_token stop = {};
  // Stop is requested when no more blocks are to begin, but those that have begun are needed.
  std::stop_token ending = {};

  bool OpensPoints() const { return !opens.empty(); }
};

// What an executor computed of a lease.
struct LeaseReport {
  std::vector<ChunkResult> chunks = {};  // complete ones, in any order
  // Of the first chunk that is not complete; or no blocks. Dropped unless the executor is local.
  PartialChunk partial = {};
  double seconds = 0;  // of processor time since the previous report about this point
  uint64_t begun = 0;  // blocks that have begun but are not merged
};

// The work that an executor can take now, in seconds of one core at nominal speed.
struct Capacity {
  bool local = true;  // the threads are this process's
  // Makes the work of a new lease that the threads here compute. All turns at the lease share it.
  std::function<std::shared_ptr<SharedWork>(const Lease&)> share = {};
  bool waits = false;  // Scheduler::Next waits until there is a lease
  // A lease has the fewest chunks that take as long as this.
  double seconds = std::numeric_limits<double>::infinity();
  // Bytes. A lease takes no more with one turn at a time.
  double memory = std::numeric_limits<double>::infinity();
  // Bytes. A lease of a local executor that takes more does not have all the rest of its point.
  double memory_of_the_rest = std::numeric_limits<double>::infinity();
  // A lease has no chunk that takes longer, unless the executor is local.
  double longest_chunk = std::numeric_limits<double>::infinity();
};

}  // namespace ballpiston::server
