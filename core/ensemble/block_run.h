// BlockRun computes the blocks of a point; BlockQueue supplies them and receives their results.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_plan.h"

namespace ballpiston {

// The thread that advances the run calls these functions.
class BlockQueue {
 public:
  virtual ~BlockQueue() = default;
  // The next block to compute; empty if there is none now.
  virtual std::optional<Block> Next() = 0;
  virtual void Done(const Block& block, BlockResult result) = 0;
  // True if the run should return. The run asks at least every 0.05 s.
  virtual bool Pause() = 0;
  // Stop is requested when the run's results are no longer needed.
  virtual std::stop_token stop() const = 0;
};

// Computes blocks of one point, several at a time where this keeps the lanes of an engine full. A
// block's result depends only on the block, not on other blocks in progress and not on pauses.
class BlockRun {
 public:
  virtual ~BlockRun() = default;
  // Returns true when no block is in progress and the queue has none now. Returns false when the
  // queue's Pause is true. May be called again in both cases, from any thread.
  virtual bool Advance() = 0;
};

// Computes one block after the other with
//   std::optional<BlockResult> compute(const Block&, const std::stop_token&)
// which returns nothing only if stop was requested.
template <typename Compute>
class OneBlockAtATime : public BlockRun {
 public:
  OneBlockAtATime(BlockQueue& queue, Compute compute)
      : queue_(queue), compute_(std::move(compute)) {}

  bool Advance() override {
    while (const std::optional<Block> block = queue_.Next()) {
      std::optional<BlockResult> result = compute_(*block, queue_.stop());
      if (result) queue_.Done(*block, *std::move(result));
      if (queue_.Pause()) return false;
    }
    return true;
  }

 private:
  BlockQueue& queue_;
  Compute compute_;
};

template <typename Compute>
std::unique_ptr<BlockRun> RunOneByOne(BlockQueue& queue, Compute compute) {
  return std::make_unique<OneBlockAtATime<Compute>>(queue, std::move(compute));
}

}  // namespace ballpiston
