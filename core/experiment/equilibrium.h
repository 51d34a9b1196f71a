// The pair in equilibrium: mean times between collisions of ball and piston, ball and wall, piston
// and wall (the paper's eqs. taubpmft and tauwall).
//
// A block is many orbits of a few collisions, each started from the return map's invariant measure,
// so nothing has to be burnt in, and orbits are independent; each is one batch of the batch means:
//   [0] (time, ball-piston collisions)  [1] (time, ball-wall hits)  [2] (time, piston-wall hits).
#ifndef BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
#define BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_

#include "core/experiment/point_experiment.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// One collision in ten counts as an event for the error (statistics/told_error.h), because long
// flights are rare and skew the law of the ratio: the z-scores of 100 seeds with 64 collisions had
// variance 1.35.
inline constexpr double kEventsPerCollision = 0.1;

// Orbits in a block, if it has as many collisions: batches enough for an error, and lanes kept
// full.
inline constexpr uint64_t kOrbitsPerBlock = 256;

class EquilibriumExperiment : public PointExperiment {
 public:
  EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point,
                        const PairGeometry& geometry);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  PairGeometry geometry_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
