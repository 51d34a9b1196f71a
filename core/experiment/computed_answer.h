// An answer that needs no samples: a point without blocks.
#ifndef BALLPISTON_CORE_EXPERIMENT_COMPUTED_ANSWER_H_
#define BALLPISTON_CORE_EXPERIMENT_COMPUTED_ANSWER_H_

#include "core/experiment/point_experiment.h"

namespace ballpiston {

class ComputedAnswer : public PointExperiment {
 public:
  // `summary` has an estimate.
  ComputedAnswer(const EnsembleSpec& spec, const PointParameters& point, PointSummary summary);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  PointSummary summary_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_COMPUTED_ANSWER_H_
