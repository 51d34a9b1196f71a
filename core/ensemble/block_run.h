// A run of a point's blocks (billiard/orbits.h). BlockQueue supplies the blocks and receives
// their results. A run computes several blocks at a time where this keeps the lanes of an engine
// full. A block's result depends only on the block, not on other blocks in progress and not on
// pauses.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_plan.h"

namespace ballpiston {

// Sees every collision of the orbits of a pair, in the order of time within an orbit.
class CollisionObserver {
 public:
  virtual ~CollisionObserver() = default;
  // `orbit`: its index within the block.
  virtual void Observe(const Block& block, uint64_t orbit, const Collision& collision) = 0;
};

// The thread that advances the run calls these functions.
class BlockQueue {
 public:
  virtual ~BlockQueue() = default;
  // The next block to compute; empty if there is none now.
  virtual std::optional<Block> Next() = 0;
  virtual void Done(const Block& block, BlockResult result) = 0;
  // True if the run should return. The run asks at least every 0.05 s, except while it starts or
  // measures a gas. This takes about 2 us per cell, so 2 s for the largest gas.
  virtual bool Pause() = 0;
  // The device that may compute the orbits of a pair (billiard/orbits.h); null: none. The results
  // do not depend on it.
  virtual OrbitDevice* device() const { return nullptr; }
  // Stop is requested when the run's results are no longer needed.
  virtual std::stop_token stop() const { return {}; }
  // Null: nobody wants to see the collisions. The run asks once.
  virtual CollisionObserver* observer() { return nullptr; }
};

// Computes one block after the other with
//   std::optional<BlockResult> compute(const Block&, const std::stop_token&)
// which returns nothing only if stop was requested.
template <typename Compute>
class OneBlockAtATime : public EngineRun {
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
std::unique_ptr<EngineRun> RunOneByOne(BlockQueue& queue, Compute compute) {
  return std::make_unique<OneBlockAtATime<Compute>>(queue, std::move(compute));
}

}  // namespace ballpiston
