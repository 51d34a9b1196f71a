// Computes a range of chunks of one point: hands out their blocks and merges each chunk's blocks.
//
// Blocks may arrive in any order, from any number of threads. A block that arrives early waits
// until all blocks before it are merged. So a chunk's result has the same bits for every order of
// arrival. Where samples continue each other, a block is handed out when its group's previous block
// has arrived. Property, with a test of its name:
//   1. BlocksAndChunksInAnyOrderGiveTheSameBits.
// Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_plan.h"

namespace ballpiston {

// The first `blocks` blocks of a chunk, merged.
struct PartialChunk {
  uint64_t chunk = 0;
  uint64_t blocks = 0;
  BlockResult merged = {};
};

struct ChunkResult {
  uint64_t chunk = 0;
  BlockResult result = {};
  // Of a chunk that the plan's end cuts short: its blocks but the last one. Empty if not known.
  PartialChunk whole_blocks = {};
};

class ChunkFold {
 public:
  // Chunks start.chunk ... end - 1 of the plan, without the first start.blocks blocks. `groups` has
  // the states from which chunks of the range start whose groups have no earlier chunk in it.
  ChunkFold(const ChunkPlan& plan, PartialChunk start, uint64_t end,
            std::vector<GroupState> groups = {}, uint64_t window = kWindow);

  // The maximum number of blocks that are handed out but not merged. It bounds the memory of blocks
  // that wait for a slow one. A smaller window would leave lanes empty.
  static constexpr uint64_t kWindow = 1024;
  // The window if, beside the orbits of one thread, so many are in progress: those of a device, or
  // kOrbitsOfAThread for each further thread. The longest orbit of a block takes about ten times as
  // long as the mean orbit, and later blocks must fill the lanes until it ends.
  static uint64_t WindowFor(const ChunkPlan& plan, uint64_t orbits);
  static constexpr uint64_t kOrbitsOfAThread = 32;
  void WidenTo(uint64_t window) { window_ = std::max(window_, window); }

  // Returns each block once; empty if no block may be handed out now.
  std::optional<Block> NextBlock();
  bool HasNextBlock() const;

  // Takes a block's result, and returns the chunks that it completes, in order. Drops a block that
  // it already has.
  std::vector<ChunkResult> Add(const Block& block, BlockResult result);

  // The merged blocks of the first incomplete chunk.
  const PartialChunk& partial() const { return partial_; }
  bool finished() const { return partial_.chunk == end_; }
  size_t waiting() const { return early_.size(); }
  // The number of blocks that are handed out but not merged.
  uint64_t handed_out() const { return handed_out_; }

 private:
  using Place = std::pair<uint64_t, uint64_t>;  // chunk, index

  // Where the next chunk of this chunk's group starts; empty if the group has not arrived there.
  const GroupState& StartOf(uint64_t chunk) const { return groups_[chunk % plan_.groups()]; }

  Place NextPlace() const { return {partial_.chunk, partial_.blocks}; }
  std::optional<ChunkResult> MergeNext(const BlockResult& block);  // the chunk that it completes

  ChunkPlan plan_;
  uint64_t end_;
  uint64_t window_;
  PartialChunk partial_;
  Place next_;  // of the next block to hand out
  uint64_t handed_out_ = 0;
  std::map<Place, BlockResult> early_;  // blocks that wait for earlier ones
  std::vector<GroupState> groups_;      // by group, empty while a block of the group is computed
};

}  // namespace ballpiston
