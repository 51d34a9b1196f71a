// The specification of a job: an experiment, a grid of parameter points, and a target.
//
// The struct holds unchecked input. `Violations` lists its errors, field by field. All other
// functions of this folder require a spec without violations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/model.h"
#include "core/ensemble/parameter.h"

namespace ballpiston {

struct ExperimentKind;

inline constexpr int64_t kDefaultSamples = 10'000;
inline constexpr int64_t kMaxSamples = 1'000'000'000'000;
inline constexpr int64_t kMaxPoints = 100'000;
inline constexpr double kMaxBudgetSeconds = 1e6;

// At most one of the numbers is set, except that a budget and a tolerance may be set together. If
// none is set, the target is kDefaultSamples samples.
struct Target {
  std::optional<int64_t> samples = {};        // a point
  std::optional<int64_t> collisions = {};     // a point: the samples expected to have so many
  std::optional<double> tolerance = {};       // relative standard error of the first estimate
  std::optional<double> budget_seconds = {};  // the caller measures it and calls PointFold::Finish
  // The name of the estimate that the tolerance and the choice of the model refer to. It is the
  // first estimate of the answer. Empty: the experiment's first aim (experiment_kind.h).
  std::string estimate = {};

  // The number of samples is not known in advance.
  bool IsOpenEnded() const { return tolerance || budget_seconds; }
};

struct EnsembleSpec {
  const ExperimentKind* experiment = nullptr;
  Grid grid = {};  // lists that the experiment needs have values; all others are empty
  Target target = {};
  uint64_t seed = 0;
  Model model = Model::kAuto;
  Precision precision = Precision::kDouble;
  bool verify = false;  // if true, AUTO does not choose the closed form
};

struct FieldViolation {
  std::string field;  // path within the spec, e.g. grid.delta[2]
  std::string description;
};

// The errors of the spec itself. Combinations of the grid's values are checked if each value is
// permitted. What the answering model cannot do is found by model_choice/ladder.h: a program that
// asks with AUTO needs its AnswerViolations too.
std::vector<FieldViolation> Violations(const EnsembleSpec& spec);

size_t PointCount(const EnsembleSpec& spec);
// With the experiment's default values. index < PointCount
PointParameters PointAt(const EnsembleSpec& spec, size_t index);

// The same spec for one of its points, by `model`, with that point's share of a budget.
EnsembleSpec OnePointSpec(const EnsembleSpec& spec, const PointParameters& point, Model model);

// True if the spec alone shows that no point needs samples. If false, AUTO may still choose the
// spectrum, which needs none.
bool NeedsNoSamples(const EnsembleSpec& spec);

// The engine that runs the orbits. In double precision the lanes are as exact as the reference, so
// AUTO uses the lanes, which are faster.
Engine EngineFor(const EnsembleSpec& spec);

}  // namespace ballpiston
