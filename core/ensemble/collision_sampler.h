// The ball-piston collisions of a point's samples as records: the raw data behind its estimates.
//
// They are the collisions that a job with the same specification folds, in the order of samples.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {

struct CollisionRecord {
  // The number of the collision, or of the orbit if a sample is an orbit of many collisions, as in
  // energy-relaxation.
  uint64_t sample = 0;
  double time = 0;       // since the orbit's start
  double free_time = 0;  // since the orbit's start or its previous collision
  PairState before = {};
  PairState after = {};
};

class CollisionSampler : private BlockQueue, private CollisionObserver {
 public:
  // The experiment, of this kind, must outlive this; it must be one with a pair, answered by a
  // billiard. Where `pause` is true, NextRecords returns soon.
  CollisionSampler(const PointExperiment& experiment, const ExperimentKind& kind,
                   std::function<bool()> pause);
  CollisionSampler(const CollisionSampler&) = delete;  // run_ holds a pointer to this object

  // Records that follow the earlier ones, some 65,536 at most; none if the pause came before the
  // next ones were complete. Empty after the last record. An orbit has no record of an escape or an
  // expiry at its end.
  std::optional<std::vector<CollisionRecord>> NextRecords();

 private:
  struct OfOrbit {
    uint64_t orbit = 0;  // within its block
    CollisionRecord record = {};
  };
  // A part of a block, as a block of its own.
  struct Part {
    Block block;
    std::vector<OfOrbit> records = {};
    bool is_done = false;
  };

  Part& Find(const Block& block);
  std::vector<CollisionRecord> InOrder(Part part) const;

  bool CountsOrbits() const { return collisions_ > 1; }
  bool HasBlock() const { return chunk_ < experiment_.plan().chunks(); }
  bool HasEnded() const { return open_.empty() && rest_.samples == 0 && !HasBlock(); }
  bool IsReady() const { return !open_.empty() && open_.front().is_done; }

  std::optional<Block> Next() override;
  void Done(const Block& block, BlockResult result) override;
  bool Pause() override { return IsReady() || pause_(); }
  CollisionObserver* observer() override { return this; }
  void Observe(const Block& block, uint64_t orbit, const Collision& collision) override;

  const PointExperiment& experiment_;
  const double collisions_;  // of a sample, at least 1
  const uint64_t most_in_a_part_;
  const std::function<bool()> pause_;
  std::deque<Part> open_;  // in order
  uint64_t open_samples_ = 0;
  Block rest_ = {};                 // of the block whose parts are being handed out
  uint64_t chunk_ = 0, index_ = 0;  // of the block after it
  std::unique_ptr<EngineRun> run_;
};

}  // namespace ballpiston
