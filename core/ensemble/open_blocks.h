// The blocks of a run that are in progress. Their parts, orbits of a pair or replicas of a gas, are
// started in order, and end in any order. When all parts of a block have ended, the block is done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/ensemble/block_run.h"

namespace ballpiston {

// The blocks that an engine computes at the same time. `Work` computes one block. It consists of
// parts, such as orbits, and has these functions:
//   uint64_t count() const;    the number of parts, at least 1
//   BlockResult Result();      called once, after all parts have ended
template <typename Work>
class OpenBlocks {
 public:
  OpenBlocks(BlockQueue& queue, std::function<Work(const Block&)> make)
      : queue_(queue), make_(std::move(make)) {}

  // The number of the next part to start. Takes a block from the queue if necessary; empty if the
  // queue has none now.
  std::optional<uint64_t> Next() {
    if (next_ == end_) {
      const std::optional<Block> block = queue_.Next();
      if (!block) return std::nullopt;
      Open(*block);
    }
    return next_++;
  }

  const Block& BlockOf(uint64_t part) const { return open_[part >> kBitsOfIndex]->block; }
  Work& WorkOf(uint64_t part) { return open_[part >> kBitsOfIndex]->work; }
  static uint64_t IndexOf(uint64_t part) { return part & kMaskOfIndex; }  // within its block

  void End(uint64_t part) {
    std::unique_ptr<OpenBlock>& open = open_[part >> kBitsOfIndex];
    if (--open->running > 0) return;
    const std::unique_ptr<OpenBlock> done = std::exchange(open, nullptr);
    queue_.Done(done->block, done->work.Result());
  }

 private:
  struct OpenBlock {
    Block block;
    Work work;
    uint64_t running;  // parts that have not ended
  };

  // A part's number is the place of its block in open_, then its index in the block.
  static constexpr int kBitsOfIndex = 32;
  static constexpr uint64_t kMaskOfIndex = (uint64_t{1} << kBitsOfIndex) - 1;

  void Open(const Block& block) {
    size_t place = 0;
    while (place < open_.size() && open_[place] != nullptr) ++place;
    if (place == open_.size()) open_.emplace_back();
    Work work = make_(block);
    const uint64_t count = work.count();
    open_[place] = std::make_unique<OpenBlock>(OpenBlock{block, std::move(work), count});
    next_ = uint64_t{place} << kBitsOfIndex;
    end_ = next_ + count;
  }

  BlockQueue& queue_;
  std::function<Work(const Block&)> make_;
  std::vector<std::unique_ptr<OpenBlock>> open_;
  uint64_t next_ = 0;  // the number of the next part
  uint64_t end_ = 0;   // of the block whose parts are being started
};

}  // namespace ballpiston
