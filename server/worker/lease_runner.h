// Computes a lease on the calling thread.
//
// Properties, each with a test of its name:
//   1. ChunksHaveTheBitsOfAWholePoint.  2. StopsAtTheTolerance.
//   3. LeasesContinueTheTrajectoriesOfASteadyState.
#pragma once

#include <stop_token>

#include "core/ensemble/chunk_fold.h"
#include "server/compute/lease.h"

namespace ballpiston::server {

// Called on the thread that computes.
class ChunkReceiver {
 public:
  virtual ~ChunkReceiver() = default;
  // A complete chunk. Chunks arrive in order.
  virtual void ChunkDone(ChunkResult chunk) = 0;
  // Processor time since the last call. Called when the run asks whether to pause
  // (BlockQueue::Pause), and after each complete chunk.
  virtual void Worked(double seconds) = 0;
};

// A lease that begins with chunk 0 ends early when its complete chunks reach the tolerance of its
// experiment. False if stop was requested before the end. The lease's own stop token is not used.
bool RunLease(const Lease& lease, const std::stop_token& stop, ChunkReceiver& receiver);

}  // namespace ballpiston::server
