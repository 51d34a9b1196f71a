// The pair in equilibrium: mean times between collisions of ball and piston, ball and wall, piston
// and wall (the paper's eqs. taubpmft and tauwall).
//
// A block is an orbit of its own, started from the return map's invariant measure, so nothing has
// to be burnt in, and blocks are independent; each is one batch of the batch means:
//   [0] (time, ball-piston collisions)  [1] (time, ball-wall hits)  [2] (time, piston-wall hits).
#ifndef BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
#define BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_

#include "core/experiment/point_experiment.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

class EquilibriumExperiment : public PointExperiment {
 public:
  EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point,
                        const PairGeometry& geometry);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  PairGeometry geometry_;
  uint64_t seed_;
  uint64_t stream_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
