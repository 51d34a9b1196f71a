#include "core/ensemble/chunk_fold.h"

#include <algorithm>

namespace ballpiston {

ChunkFold::ChunkFold(const ChunkPlan& plan, PartialChunk start, uint64_t end,
                     std::vector<GroupState> groups, uint64_t window)
    : plan_(plan),
      end_(end),
      window_(window),
      partial_(std::move(start)),
      next_(NextPlace()),
      groups_(std::move(groups)) {
  groups_.resize(plan.groups());
}

uint64_t ChunkFold::WindowFor(const ChunkPlan& plan, uint64_t orbits) {
  constexpr uint64_t kLongestOrbit = 16, kMost = 16 * kWindow;
  return std::min(kWindow + kLongestOrbit * orbits / plan.MostInABlock(), kMost);
}

bool ChunkFold::HasNextBlock() const {
  if (next_.first >= end_ || handed_out_ >= window_) return false;
  return next_.first < plan_.groups() || plan_.groups() == 0 || !StartOf(next_.first).empty();
}

std::optional<Block> ChunkFold::NextBlock() {
  if (!HasNextBlock()) return std::nullopt;
  Block block = plan_.BlockAt(next_.first, next_.second);
  if (plan_.groups() > 0) {
    block.start = std::exchange(groups_[block.chunk % plan_.groups()], GroupState());
  }
  ++handed_out_;
  if (++next_.second == plan_.BlocksIn(next_.first)) next_ = {next_.first + 1, 0};
  return block;
}

std::vector<ChunkResult> ChunkFold::Add(const Block& block, BlockResult result) {
  std::vector<ChunkResult> complete;
  const Place place = {block.chunk, block.index};
  if (place < NextPlace() || early_.contains(place)) return complete;
  if (!result.groups.empty()) {
    const uint64_t group = block.chunk % plan_.groups();
    groups_[group] = result.groups[group];
  }
  early_.emplace(place, std::move(result));
  while (const auto next = early_.extract(NextPlace())) {
    if (auto chunk = MergeNext(next.mapped())) complete.push_back(*std::move(chunk));
  }
  return complete;
}

std::optional<ChunkResult> ChunkFold::MergeNext(const BlockResult& block) {
  const bool is_last = partial_.blocks + 1 == plan_.BlocksIn(partial_.chunk);
  PartialChunk whole_blocks;
  if (is_last && partial_.chunk >= plan_.FirstCutChunk()) whole_blocks = partial_;
  partial_.merged.Merge(block);
  ++partial_.blocks;
  --handed_out_;
  if (!is_last) return std::nullopt;
  PartialChunk merged = std::exchange(partial_, {.chunk = partial_.chunk + 1});
  return ChunkResult{merged.chunk, std::move(merged.merged), std::move(whole_blocks)};
}

}  // namespace ballpiston
