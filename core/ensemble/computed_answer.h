// An answer that needs no samples: a point without blocks.
#pragma once

#include <memory>

#include "core/ensemble/point_experiment.h"

namespace ballpiston {

class ComputedAnswer : public PointExperiment {
 public:
  // `summary` has an estimate.
  ComputedAnswer(const EnsembleSpec& spec, const PointParameters& point, PointSummary summary);

  std::unique_ptr<BlockRun> StartRun(BlockQueue& queue) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  PointSummary summary_;
};

}  // namespace ballpiston
