#include "core/ensemble/computed_answer.h"

#include <utility>

namespace ballpiston {

ComputedAnswer::ComputedAnswer(const EnsembleSpec& spec, const PointParameters& point,
                               PointSummary summary)
    : PointExperiment(spec, point, ChunkPlan()), summary_(std::move(summary)) {}

std::unique_ptr<BlockRun> ComputedAnswer::StartRun(BlockQueue& queue) const {
  return RunOneByOne(
      queue, [](const Block&, const std::stop_token&) { return std::optional(BlockResult()); });
}

BlockResult ComputedAnswer::EmptyResult() const { return BlockResult(); }

Estimate ComputedAnswer::FirstEstimate(const BlockResult&) const {
  return summary_.estimates.front();
}

PointSummary ComputedAnswer::Summarize(const BlockResult&) const { return summary_; }

}  // namespace ballpiston
