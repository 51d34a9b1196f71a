// An experiment at one point of the grid: a plan of chunks and blocks, a pure function that
// computes blocks, and a table of the estimates in the merged blocks. The server, the tools and the
// tests use these; point_fold.h combines them.
//
// A block depends only on (experiment, point, model, precision, seed, the block's samples): not on
// the other points of the grid, not on threads and not on earlier calls. Immutable; safe to share
// between threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_result.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/chunk_plan.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/measurement.h"
#include "core/ensemble/point_summary.h"
#include "core/ensemble/random_stream.h"

namespace ballpiston {

struct AimedEstimate;
struct Forecast;

// The model that answers, and its error.
struct Answer {
  Model model = Model::kBilliard;  // not kAuto
  std::string reason = {};         // why the service chose this model; empty if the user chose it
  // Upper bound of the relative difference between the model's first estimate and the billiard's,
  // without the statistical error. Empty if no bound is known.
  std::optional<double> model_error = 0.0;
  // The same for other estimates, by their names. If model_error is 0, it counts for all estimates.
  std::map<std::string, double, std::less<>> further_errors = {};

  // The model error of the estimate with this name.
  std::optional<double> ModelErrorOf(std::string_view name, bool is_first) const;
};

// The relative standard error; infinite if there is none.
double RelativeError(const Estimate& estimate);

class PointExperiment {
 public:
  virtual ~PointExperiment() = default;
  // The table's readings may refer to the experiment.
  PointExperiment(const PointExperiment&) = delete;
  PointExperiment& operator=(const PointExperiment&) = delete;

  // The spec must have no violations; index < PointCount(spec). Uses the spec's own model; for AUTO
  // the billiard, which answers every experiment, in its domain (billiard/billiard_domain.h).
  static std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index);
  // Uses the model of `answer`, which must be able to answer the experiment.
  static std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index,
                                                       Answer answer);

  // If the plan has no samples, the answer needs no block, and `merged` is empty.
  const ChunkPlan& plan() const { return plan_; }
  // The chunks that the target is expected to take: with a tolerance fewer than the plan has.
  uint64_t expected_chunks() const { return plan_.ChunksFor(expected_samples_); }
  const PointParameters& parameters() const { return parameters_; }
  const Answer& answer() const { return answer_; }

  // The queue must outlive the run. The queue's Next must return blocks of plan(). Null without
  // blocks.
  virtual std::unique_ptr<EngineRun> StartRun(BlockQueue& /*queue*/) const { return nullptr; }

  // The result before any block. It has the accumulators that every block has; merging needs them.
  const BlockResult& EmptyResult() const { return empty_; }

  // Whether a block can start from this state, which may be damaged.
  virtual bool CanContinue(const GroupState& /*state*/) const { return false; }

  // The largest number of counts in one histogram that a sample adds.
  virtual uint64_t CountsOfASample() const { return 1; }

  // The estimate that a tolerance refers to. This and Summarize require at least one merged block
  // if the plan has blocks.
  Estimate FirstEstimate(const BlockResult& merged) const;

  // All that was measured. The first estimate is FirstEstimate. If it has no standard error, a
  // remark says how many samples an error needs. Without estimates a remark says why.
  PointSummary Summarize(const BlockResult& merged) const;

  // Whether `merged`, the complete chunks, reaches the tolerance; false if there is no tolerance,
  // or if fewer than a quarter of the samples that it is expected to need are measured.
  bool ReachesTolerance(const BlockResult& merged) const;

  const std::optional<double>& tolerance() const { return tolerance_; }

  // The orbits and replicas of a run use these two.
  Engine engine() const { return engine_; }
  const RandomStream& random() const { return random_; }

 protected:
  // The second one has a plan of its own, as tests want it.
  PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters);
  PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters,
                  const ChunkPlan& plan);

  // To be called in the constructor of an experiment. If the table has the estimate that the target
  // names, it becomes the first one, before its multiples. The first row must have an estimate for
  // every sample, or be known if the model takes none.
  void SetMeasurements(BlockResult empty, std::vector<Measurement> table);

  // Adds histograms, curves and remarks, and estimates that are not in the table. The summary
  // already has the table's estimates.
  virtual void AddDetails(const BlockResult& /*merged*/, PointSummary& /*summary*/) const {}
  // A remark, if the first estimate has no standard error.
  virtual std::string ReasonOfNoError(absl::string_view estimate) const;

 private:
  PointParameters parameters_;
  Answer answer_;
  Engine engine_;
  ChunkPlan plan_;
  double expected_samples_;  // that reach the tolerance; infinite without one
  const AimedEstimate* aim_;
  std::optional<double> tolerance_;
  RandomStream random_;
  BlockResult empty_;
  std::vector<Measurement> table_;
};

// Creates an experiment. Rows of experiments refer to this function.
template <typename Experiment>
std::unique_ptr<PointExperiment> CreateAs(const EnsembleSpec& spec, const PointParameters& point) {
  return std::make_unique<Experiment>(spec, point);
}

// The largest number of samples that the target requests at a point; 1 to kMaxSamples.
uint64_t SamplesAskedFor(const Target& target, const Forecast& forecast);

// The samples that the point takes, by spec.model; for AUTO, by the billiard.
ChunkPlan PlanFor(const EnsembleSpec& spec, const PointParameters& point);

// The time of this many samples of the point, or of all if the target asks for fewer, on one core
// at nominal speed, by spec.model. Requires a model that samples.
double NominalSeconds(const EnsembleSpec& spec, const PointParameters& point, double samples);

}  // namespace ballpiston
