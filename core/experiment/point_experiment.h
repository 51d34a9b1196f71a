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
#include <string>

#include "core/billiard/orbits.h"
#include "core/experiment/block_plan.h"
#include "core/experiment/block_result.h"
#include "core/experiment/ensemble_spec.h"
#include "core/experiment/point_summary.h"
#include "core/experiment/random_stream.h"

namespace ballpiston {

// Which model answers, and what is known of it.
struct Answer {
  Model model = Model::kBilliard;  // not kAuto
  std::string reason = {};         // why that one, where the service chose
  // How far its first estimate may be from the billiard's, relatively and sampling apart. Empty
  // where that is not known.
  std::optional<double> model_error = 0.0;
};

// Whether its relative standard error, if it has one, is at most that.
bool MeetsTolerance(const Estimate& estimate, double tolerance);

class PointExperiment {
 public:
  virtual ~PointExperiment() = default;

  // The spec must have no violations; index < PointCount(spec). With the spec's own model; AUTO is
  // the billiard, which answers everything.
  static std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index);
  // With the model of `answer`, which has to be one that the experiment can be answered by.
  static std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index,
                                                       Answer answer);

  // A plan without blocks: the answer is there without running one, and `merged` is empty.
  const BlockPlan& plan() const { return plan_; }
  const PointParameters& parameters() const { return parameters_; }
  const Answer& answer() const { return answer_; }

  // Empty only if `stop` was requested. A block takes some 0.05 s (one sample at least).
  virtual std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const = 0;

  // No block yet: with the accumulators that every block has, and that merging relies on.
  virtual BlockResult EmptyResult() const = 0;

  // What a tolerance refers to. Requires at least one merged block, if there are any,
  // as Summarize does.
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
  Answer answer_;
  Engine engine_;
  BlockPlan plan_;
  RandomStream random_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_POINT_EXPERIMENT_H_
