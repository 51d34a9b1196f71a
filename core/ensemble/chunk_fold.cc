#include "core/ensemble/chunk_fold.h"

namespace ballpiston {

ChunkFold::ChunkFold(const ChunkPlan& plan, PartialChunk start, uint64_t end)
    : plan_(plan), end_(end), partial_(std::move(start)), next_(NextPlace()) {}

bool ChunkFold::HasNextBlock() const { return next_.first < end_ && handed_out_ < kWindow; }

std::optional<Block> ChunkFold::NextBlock() {
  if (!HasNextBlock()) return std::nullopt;
  const Block block = plan_.BlockAt(next_.first, next_.second);
  ++handed_out_;
  if (++next_.second == plan_.BlocksIn(next_.first)) next_ = {next_.first + 1, 0};
  return block;
}

std::vector<ChunkResult> ChunkFold::Add(const Block& block, BlockResult result) {
  std::vector<ChunkResult> complete;
  const Place place = {block.chunk, block.index};
  if (place < NextPlace()) return complete;
  early_.Add(place, std::move(result));
  while (const std::optional<BlockResult> next = early_.Take(NextPlace())) {
    partial_.merged.Merge(*next);
    --handed_out_;
    if (++partial_.blocks < plan_.BlocksIn(partial_.chunk)) continue;
    complete.push_back({partial_.chunk, std::exchange(partial_.merged, {})});
    partial_.blocks = 0;
    ++partial_.chunk;
  }
  return complete;
}

}  // namespace ballpiston
