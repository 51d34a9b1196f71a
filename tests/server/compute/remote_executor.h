// An executor elsewhere, which a test drives step by step, and the damage that its chunks can take.
//
// The test decides when a lease is taken, which chunks are reported, how often and in which order,
// and whether the lease is returned. Only Wake may be called from another thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/point_fold.h"
#include "server/compute/scheduler.h"

namespace ballpiston::server {

// The chunks of a lease in order, with what the lease has of its first chunk.
inline std::vector<ChunkResult> ComputedChunks(const Lease& lease,
                                               const PointExperiment& experiment) {
  ChunkFold fold(experiment.plan(), lease.start, lease.end);
  std::vector<ChunkResult> chunks;
  while (const std::optional<Block> block = fold.NextBlock()) {
    for (ChunkResult& chunk : fold.Add(*block, *RunBlock(experiment, *block))) {
      chunks.push_back(std::move(chunk));
    }
  }
  return chunks;
}

inline std::vector<ChunkResult> ComputedChunks(const Lease& lease) {
  return ComputedChunks(lease, *lease.experiment);
}

// ---- damaged chunks ----

inline ChunkResult WithAnotherHistogram(ChunkResult chunk) {
  chunk.result.histograms.push_back({.lower = 0, .upper = 1, .counts = {0, 0}});
  return chunk;
}

inline ChunkResult WithTooManySamples(ChunkResult chunk) {
  chunk.result.samples = std::numeric_limits<uint64_t>::max();
  return chunk;
}

inline ChunkResult WithNumber(ChunkResult chunk, uint64_t number) {
  chunk.chunk = number;
  return chunk;
}

class RemoteExecutor : public Executor {
 public:
  // A lease has the fewest chunks that take `seconds`; a fake sample takes 0.02 s.
  explicit RemoteExecutor(Scheduler& scheduler, double seconds = 10)
      : scheduler_(scheduler),
        capacity_{.executor = scheduler.AddExecutor(*this), .local = false, .seconds = seconds} {}

  ~RemoteExecutor() override { scheduler_.RemoveExecutor(capacity_.executor); }

  void Wake() override {}
  void Shutdown() override { is_shut_down_ = true; }

  size_t number() const { return capacity_.executor; }

  // These call the scheduler unless this is shut down.
  std::optional<Lease> Take() { return is_shut_down_ ? std::nullopt : scheduler_.Next(capacity_); }
  absl::Status Report(const Lease& lease, std::vector<ChunkResult> chunks, double seconds = 0) {
    if (is_shut_down_) return absl::OkStatus();
    return scheduler_.Report(lease, {.chunks = std::move(chunks), .seconds = seconds});
  }
  absl::Status ReportAll(const Lease& lease) { return Report(lease, ComputedChunks(lease)); }
  void Return(const Lease& lease, bool tried = true) {
    if (!is_shut_down_) scheduler_.Return(lease, tried);
  }

 private:
  Scheduler& scheduler_;
  const Capacity capacity_;
  std::atomic<bool> is_shut_down_ = false;
};

}  // namespace ballpiston::server
