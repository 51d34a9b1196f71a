#include "core/experiment/computed_answer.h"

#include <utility>

namespace ballpiston {

ComputedAnswer::ComputedAnswer(const EnsembleSpec& spec, const PointParameters& point,
                               PointSummary summary)
    : PointExperiment(spec, point, BlockPlan{.samples = 0}), summary_(std::move(summary)) {}

std::optional<BlockResult> ComputedAnswer::RunBlock(uint64_t, std::stop_token) const {
  return BlockResult();
}

BlockResult ComputedAnswer::EmptyResult() const { return BlockResult(); }

Estimate ComputedAnswer::FirstEstimate(const BlockResult&) const {
  return summary_.estimates.front();
}

PointSummary ComputedAnswer::Summarize(const BlockResult&) const { return summary_; }

}  // namespace ballpiston
