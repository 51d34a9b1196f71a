// Computes the chunks of a lease, as a worker does.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/ensemble/point_fold.h"
#include "server/worker/lease_file.h"

namespace ballpiston::server {

// The chunks of a lease in order, computed block by block, with what the lease has of its first
// chunk.
inline std::vector<ChunkResult> ComputedChunks(const Lease& lease) {
  ChunkFold fold(lease.experiment->plan(), lease.start, lease.end, lease.groups);
  std::vector<ChunkResult> chunks;
  while (const std::optional<Block> block = fold.NextBlock()) {
    for (ChunkResult& chunk : fold.Add(*block, RunBlock(*lease.experiment, *block))) {
      chunks.push_back(std::move(chunk));
    }
  }
  return chunks;
}

}  // namespace ballpiston::server
