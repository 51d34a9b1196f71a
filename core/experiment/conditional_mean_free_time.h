// The mean return time to the ball-piston collision surface at fixed energies, started from the
// invariant law (the paper's eq. taubpmftep). Exact at every delta, so it tests the billiard, not
// the limit. Moments: [0] return time.
#ifndef BALLPISTON_CORE_EXPERIMENT_CONDITIONAL_MEAN_FREE_TIME_H_
#define BALLPISTON_CORE_EXPERIMENT_CONDITIONAL_MEAN_FREE_TIME_H_

#include "core/experiment/point_experiment.h"
#include "core/experiment/return_time.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

class ConditionalMeanFreeTimeExperiment : public PointExperiment {
 public:
  ConditionalMeanFreeTimeExperiment(const EnsembleSpec& spec, const PointParameters& point,
                                    const PairGeometry& geometry);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  PairGeometry geometry_;
  ReturnTime return_time_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_CONDITIONAL_MEAN_FREE_TIME_H_
