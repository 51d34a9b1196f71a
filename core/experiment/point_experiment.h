// An experiment at one point of the grid: a plan of blocks, a pure function that runs one, and a
// summary of what was merged. The local pool, restarts and tests all use these three.
//
//   for b in [0, blocks):  merged.Merge(RunBlock(b));  stop once TargetReached(b + 1, merged)
//
// RunBlock depends on nothing but (experiment, point, model, precision, seed, target, block): not
// on the other points of the grid, on threads or on earlier calls. Immutable; safe to share between
// threads.
#ifndef BALLPISTON_CORE_EXPERIMENT_POINT_EXPERIMENT_H_
#define BALLPISTON_CORE_EXPERIMENT_POINT_EXPERIMENT_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "core/billiard/orbits.h"
#include "core/experiment/block_plan.h"
#include "core/experiment/block_result.h"
#include "core/experiment/ensemble_spec.h"
#include "core/experiment/point_summary.h"
#include "core/experiment/random_stream.h"

namespace ballpiston {

class PointExperiment {
 public:
  virtual ~PointExperiment() = default;

  // The spec must have no violations; index < PointCount(spec).
  static std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index);

  const BlockPlan& plan() const { return plan_; }
  const PointParameters& parameters() const { return parameters_; }
  Model model() const;  // the one that answers

  // Empty only if `stop` was requested. A block takes some 0.05 s (one sample at least).
  virtual std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const = 0;

  // What a tolerance refers to. Requires at least one merged block, as Summarize does.
  virtual Estimate FirstEstimate(const BlockResult& merged) const = 0;

  // Everything that was measured; its first estimate is FirstEstimate.
  virtual PointSummary Summarize(const BlockResult& merged) const = 0;

  // Whether the first `blocks` blocks, merged in order, are all that the target asks for.
  bool TargetReached(uint64_t blocks, const BlockResult& merged) const;

 protected:
  PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters,
                  const BlockPlan& plan);

  Engine engine() const { return engine_; }
  const RandomStream& random() const { return random_; }

 private:
  PointParameters parameters_;
  Engine engine_;
  BlockPlan plan_;
  RandomStream random_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_POINT_EXPERIMENT_H_
