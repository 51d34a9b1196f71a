// Each experiment has one row, which describes it to the rest of the program. The row stands in the
// experiment's file, and experiment/all_experiments.h lists all rows. Validation, plans, ladder,
// predictions and random streams read rows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/ensemble/chunk_plan.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {

class PointExperiment;

// The work of a sample in mean numbers of events, for chunk plans and for predictions of its cost
// on a machine.
struct SampleWork {
  double ball_wall = 0;
  double piston_wall = 0;
  double collisions = 0;  // of ball and piston, in orbits that continue
  double starts = 0;      // of orbits, with their ends, in units of the simplest start
  double jumps = 0;       // of the limit's jump process, or measurements of a step of the energy

  // The rest tells how costs differ from the sum of the events. Chunk plans do not depend on it.
  double delays = 0;  // further time in lanes, in wall hits; below 0: these hits are missing
  // The number of independent parts of a sample, for instance its collisions, whose durations add
  // up. Below 1: only this share of the samples takes long.
  double parts = 1;
  // Replicas of a gas that a thread runs from start to end together; 0 for orbits, of which each
  // lane takes the next one when its orbit has ended.
  double together = 0;

  // The sum, in units of a wall hit in lanes.
  double Events() const {
    constexpr double kEventsPerJump = 25;
    return ball_wall + piston_wall + collisions + starts + kEventsPerJump * jumps;
  }

  SampleWork Times(double n) const {
    return {n * ball_wall, n * piston_wall, n * collisions, n * starts,
            n * jumps,     n * delays,      n * parts,      together};
  }
};

// Predictions about one sample of a model that takes samples.
struct Forecast {
  SampleWork work = {};
  double collisions = 1;  // mean number of ball-piston collisions
  // Upper bound of the bytes of one thread that takes samples (MemoryOf).
  double memory = 0;
  // The trajectories of the point, if its samples continue each other.
  std::optional<Trajectories> trajectories = {};
};

// How much the samples of one estimate scatter.
struct Scatter {
  // The relative standard error of one sample. It is infinite if no number of samples is enough.
  double error = 0;
  // The expected number of events of a sample. An error needs kEventsForAnError events
  // (statistics/stated_error.h).
  double events = 1;
  // The least relative error that is stated, whatever the number of samples.
  double least = kRoundingOfAMean;

  // The relative standard error of n samples: 1/sqrt(n) times that of one sample, but at least
  // `least`; infinite if n samples are too few for an error.
  double ErrorOf(double samples) const;
  // The fewest samples that have an error; infinite if no number of samples is enough.
  double SamplesForAnError() const;
  // The expected number of samples that reach the relative standard error `tolerance`.
  double SamplesFor(double tolerance) const;
};

struct ParameterUse {
  const Parameter* parameter;
  bool needed = true;                        // or optional
  std::optional<double> default_value = {};  // of every point if the list is empty
};

// An estimate that a target can name. The tolerance, the predicted error and the choice of the
// model refer to it, and it is the first estimate of the answer.
struct AimedEstimate {
  absl::string_view name;
  std::span<const Model> models;  // that can answer it; cheapest first
  Scatter (*scatter)(Model model, const PointParameters& point);  // by a model that takes samples
  // Upper bound of the relative difference between the limit delta -> 0 and the billiard; empty
  // where none is known. Null: none is known at any point.
  std::optional<double> (*limit_error)(const PointParameters& point) = nullptr;
  // The relative error of the model without samples. Null if all models take samples.
  double (*numerical_error)(const PointParameters& point) = nullptr;
  // Why no number of samples gives a relative error at some points, and what is permitted there.
  absl::string_view no_error = {};
  // Names of estimates that are this one in other units, so that they have its relative errors.
  std::span<const absl::string_view> multiples = {};

  // Besides AUTO, which answers everything.
  bool IsAnsweredBy(Model model) const;
  bool HasClosedForm() const { return IsAnsweredBy(Model::kClosedForm); }
  // The limit's error at the point, where it is known.
  std::optional<double> LimitErrorAt(const PointParameters& point) const {
    return limit_error == nullptr ? std::nullopt : limit_error(point);
  }
};

struct ExperimentKind {
  absl::string_view name;  // as users write it: "first-hit"
  uint64_t number;         // as in the API; decides the random streams
  std::span<const ParameterUse> parameters;
  // The first one is the default. Its models include those of all others.
  std::span<const AimedEstimate> aims;

  // `spec` has one point, which is `point`, and a model of `models`.
  std::unique_ptr<PointExperiment> (*create)(const EnsembleSpec& spec,
                                             const PointParameters& point);
  // Finds combinations of values, or of values, model and precision, that are not permitted
  // although each value alone is. Requires that every value is permitted and that no needed list is
  // empty.
  void (*check_grid)(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

  Forecast (*forecast)(Model model, const PointParameters& point);
  double summary = 0;                // the work of a point's summary, in jumps
  double memory_of_a_result = 20e3;  // upper bound of the bytes of a block's result (MemoryOf)

  // Samples of one orbit, which are measured together; a power of two up to 64.
  uint64_t samples_together = 1;

  // The exact probabilities of the bins of each histogram; for the energy at a time those of the
  // limit delta -> 0. They sum to 1 over the histograms of one law: over both signs of the piston's
  // velocity together, and over each other histogram. Null if the experiment has no histograms, or
  // no law of them is known.
  std::vector<std::vector<double>> (*expected_probabilities)(const PointParameters& point) =
      nullptr;

  // The models that can answer one of the aims; cheapest first.
  std::span<const Model> models() const { return aims.front().models; }
  bool IsAnsweredBy(Model model) const { return aims.front().IsAnsweredBy(model); }
  // The aim of this name; the default if the name is empty, null if there is none.
  const AimedEstimate* FindAim(absl::string_view aim) const;
};

// The aim that the spec's target names. For this and the next two the spec must have no violations.
const AimedEstimate& AimOf(const EnsembleSpec& spec);
// The forecast and the scatter of a sample by spec.model; for AUTO, by the billiard.
Forecast ForecastOf(const EnsembleSpec& spec, const PointParameters& point);
Scatter ScatterOf(const EnsembleSpec& spec, const PointParameters& point);

// In the order of their numbers; experiment/all_experiments.h.
std::span<const ExperimentKind* const> AllExperiments();
// Null if no experiment has this number.
const ExperimentKind* FindExperiment(uint64_t number);

// Upper bound of the bytes of a point while up to `threads` threads compute it: the state of the
// engines, the blocks in progress, and the results that wait to be merged. It is known before the
// computation starts: the scheduler keeps the sum over the running points below a limit, and a
// question beyond the machine's memory is rejected. Two things are not counted: a device's buffers,
// and the results that wait in a device's larger window (ChunkFold::WindowFor). Uses
// spec.model; for AUTO the billiard, unless a closed form answers. The spec must have no
// violations.
double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads);

}  // namespace ballpiston
