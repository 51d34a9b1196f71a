// Computes leases one after the other on the calling thread.
//
// Properties, each with a test of its name:
//   1. ChunksHaveTheBitsOfAWholePoint.  2. ComputesOnlyMissingChunks.
//   3. StopsAtTheTolerance.  4. LeasesContinueTheTrajectoriesOfASteadyState.
#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "core/ensemble/chunk_fold.h"
#include "server/compute/lease.h"

namespace ballpiston::server {

struct LeaseWork {
  Lease lease;                          // of chunks; its stop token is not used
  std::vector<ChunkResult> known = {};  // chunks of it that are not to be computed again
};

// Called on the thread that computes.
class ChunkReceiver {
 public:
  virtual ~ChunkReceiver() = default;
  // False if the lease is to be left out.
  virtual bool LeaseBegins(size_t /*lease*/) { return true; }
  // A complete chunk of the lease with this index. Chunks of a lease arrive in order.
  virtual void ChunkDone(size_t lease, ChunkResult chunk) = 0;
  // Processor time on this lease since the last call. Called at least every 0.05 s, and after each
  // complete chunk.
  virtual void Worked(size_t lease, double seconds) = 0;
};

// Computes the missing chunks of each lease. A lease that begins with chunk 0 ends early when its
// complete chunks reach the tolerance of its experiment. False if stop was requested before the
// end.
bool RunLeases(const std::vector<LeaseWork>& work, const std::stop_token& stop,
               ChunkReceiver& receiver);

}  // namespace ballpiston::server
