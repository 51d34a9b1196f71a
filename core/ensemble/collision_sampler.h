// The ball-piston collisions of a point's samples as records: the raw data behind its estimates.
//
// They are the collisions that a job with the same specification folds, in the order of samples.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {

struct CollisionRecord {
  // The number of the collision, or of the orbit if the experiment counts orbits: those of
  // energy-relaxation have many collisions.
  uint64_t sample = 0;
  double time = 0;       // since the orbit's start
  double free_time = 0;  // since the orbit's start or its previous collision
  PairState before = {};
  PairState after = {};
};

class CollisionSampler : private BlockQueue, private CollisionObserver {
 public:
  // `unit`: of the experiment's target. The experiment must outlive this; it must be one with a
  // pair, answered by a billiard.
  CollisionSampler(const PointExperiment& experiment, TargetUnit unit);

  // The records of the next block, of at most some 65,536 samples; empty after the last block. An
  // orbit has no record of an escape or an expiry at its end.
  std::vector<CollisionRecord> NextRecords();

 private:
  struct OfOrbit {
    uint64_t orbit = 0;  // within its block
    CollisionRecord record = {};
  };
  struct OpenBlock {
    Block block;
    std::vector<OfOrbit> records = {};
    bool is_done = false;
  };

  OpenBlock& Find(const Block& block);
  std::vector<CollisionRecord> InOrder(OpenBlock open) const;

  std::optional<Block> Next() override;
  void Done(const Block& block, BlockResult result) override;
  bool Pause() override { return !open_.empty() && open_.front().is_done; }
  std::stop_token stop() const override { return {}; }
  CollisionObserver* observer() override { return this; }
  void Observe(const Block& block, uint64_t orbit, const Collision& collision) override;

  const PointExperiment& experiment_;
  const TargetUnit unit_;
  std::deque<OpenBlock> open_;  // in order
  uint64_t open_samples_ = 0;
  uint64_t chunk_ = 0, index_ = 0;  // of the next block
  std::unique_ptr<EngineRun> run_;
};

}  // namespace ballpiston
