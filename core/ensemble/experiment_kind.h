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
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/sample_work.h"

namespace ballpiston {

class PointExperiment;

struct ParameterUse {
  const Parameter* parameter;
  bool needed = true;                        // or optional
  std::optional<double> default_value = {};  // of every point if the list is empty
};

// The unit of a number in the target.
enum class TargetUnit { kSamples, kCollisions, kEither };

// How far the limit delta -> 0 is from the billiard, in one estimate.
struct LimitError {
  Model model;      // the cheapest one that answers in the limit
  bool has_pilots;  // whether pilot runs can check the bound (model_choice/limit_error.h)
  bool (*is_known)(const PointParameters& point);
  double (*expected)(const PointParameters& point);  // upper bound of the relative error

  // Whether the limit may answer a question with this tolerance. If its model samples, half of the
  // tolerance is for the scatter. Requires is_known.
  bool IsWithin(double tolerance, const PointParameters& point) const;
};

// An estimate that a target can name. The tolerance, the predicted error and the choice of the
// model refer to it, and it is the first estimate of the answer.
struct AimedEstimate {
  absl::string_view name;
  std::span<const Model> models;  // that can answer it; cheapest first
  // The relative standard error of one sample by a model that takes samples. The error of n samples
  // is 1/sqrt(n) times that of one; it is infinite if no number of samples is enough.
  double (*error)(Model model, const PointParameters& point);
  // The expected number of a sample's events, of which an error needs kEventsForAnError
  // (statistics/told_error.h). Null: 1.
  double (*events)(Model model, const PointParameters& point) = nullptr;
  const LimitError* limit_error = nullptr;  // null: no bound is known
  // Names of estimates that are this one in other units, so that they have its relative errors.
  std::span<const absl::string_view> multiples = {};

  // Besides AUTO, which answers everything.
  bool IsAnsweredBy(Model model) const;
  bool HasClosedForm() const { return IsAnsweredBy(Model::kClosedForm); }
  // The fewest samples that have an error; infinite if no number of samples is enough.
  double SamplesForAnError(Model model, const PointParameters& point) const;
};

struct ExperimentKind {
  absl::string_view name;  // as users write it: "first-hit"
  uint64_t number;         // as in the API; decides the random streams
  std::span<const ParameterUse> parameters;
  TargetUnit unit = TargetUnit::kSamples;
  std::span<const Model> models;        // that can answer one of the aims; cheapest first
  std::span<const AimedEstimate> aims;  // the first one is the default

  // `spec` has one point, which is `point`, and a model of `models`.
  std::unique_ptr<PointExperiment> (*create)(const EnsembleSpec& spec,
                                             const PointParameters& point);
  // Finds combinations of values, or of values and precision, that are not permitted although each
  // value alone is.
  void (*check_grid)(const EnsembleSpec& spec, std::vector<FieldViolation>& found);
  // Finds why sampling cannot reach a tolerance; null if it always can.
  void (*check_tolerance)(const EnsembleSpec& spec, std::vector<FieldViolation>& found) = nullptr;

  // The reason why an answer by samples of `model` states no errors at this point, whatever the
  // number of samples, and the permitted range; empty if it states errors. Null: it always does.
  std::string (*no_errors)(Model model, const PointParameters& point) = nullptr;

  // These two describe one sample by `model`: its work, and its mean number of ball-piston
  // collisions.
  SampleWork (*work)(Model model, const PointParameters& point);
  double (*collisions)(Model model, const PointParameters& point);
  double summary = 0;  // the work of a point's summary, in jumps

  // Upper bounds of the bytes of one thread that takes samples, and of a block's result
  // (point_memory.h).
  double (*memory)(Model model, const PointParameters& point);
  double memory_of_a_result = 20e3;

  // Samples of one orbit, which are measured together; a power of two up to 64.
  uint64_t samples_together = 1;

  // The exact probabilities of the bins of each histogram; for the energy at a time those of the
  // limit delta -> 0. They sum to 1 over the histograms of one law: over both signs of the piston's
  // velocity together, and over each other histogram. Null if the experiment has no histograms, or
  // no law of them is known.
  std::vector<std::vector<double>> (*expected_probabilities)(const PointParameters& point) =
      nullptr;

  // Besides AUTO, which answers everything.
  bool IsAnsweredBy(Model model) const;
  // The aim of this name; the default if the name is empty, null if there is none.
  const AimedEstimate* FindAim(absl::string_view aim) const;
};

// The aim that the spec's target names. The spec must have no violations.
const AimedEstimate& AimOf(const EnsembleSpec& spec);

// In the order of their numbers; experiment/all_experiments.cc.
std::span<const ExperimentKind* const> AllExperiments();
// Null if no experiment has this number.
const ExperimentKind* FindExperiment(uint64_t number);

}  // namespace ballpiston
