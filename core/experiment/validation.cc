// Everything that can be wrong with a specification, field by field.
#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/pair_measures.h"
#include "core/experiment/answering_models.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/ensemble_spec.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {
namespace {

using Found = std::vector<FieldViolation>;

enum class Use { kNone, kOptional, kNeeded };

Use UseOfEpsilon(Experiment experiment) {
  switch (experiment) {
    case Experiment::kConditionalMeanFreeTime:
    case Experiment::kFirstHit:
      return Use::kNeeded;
    case Experiment::kEnergyRelaxation:
      return Use::kOptional;
    default:
      return Use::kNone;
  }
}

Use UseOfExponent(Experiment experiment) {
  return experiment == Experiment::kFirstHit ? Use::kNeeded : Use::kNone;
}

std::string At(absl::string_view list, size_t i) { return absl::StrFormat("grid.%s[%d]", list, i); }

void CheckUse(Experiment experiment, absl::string_view list, Use use, size_t size, Found* found) {
  if (use == Use::kNeeded && size == 0) {
    found->push_back({absl::StrCat("grid.", list),
                      absl::StrCat("is empty; ", Name(experiment), " needs at least one value")});
  }
  if (use == Use::kNone && size != 0) {
    found->push_back({absl::StrCat("grid.", list),
                      absl::StrCat("has ", size, " values; ", Name(experiment), " takes none")});
  }
}

void CheckRange(absl::string_view list, const std::vector<double>& values, double lower,
                double upper, Found* found) {
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i] >= lower && values[i] <= upper) continue;
    found->push_back({At(list, i), absl::StrCat(list, " is ", NumberText(values[i]),
                                                "; permitted: [", lower, ", ", upper, "]")});
  }
}

bool HasFiniteTimes(double rho, double delta) {
  const PairMeasures measures = Measures(PairGeometry::Create(rho, delta).value());
  // Not a denormal number either: it would have lost its digits.
  return measures.area_ball_piston >= std::numeric_limits<double>::min();
}

void CheckGeometry(const Grid& grid, Found* found) {
  // The largest valid rho has the smallest bound, and the smallest has the longest times: these two
  // decide for every delta.
  double largest = 0, smallest = kMaxRho;
  for (size_t i = 0; i < grid.rho.size(); ++i) {
    const absl::Status status = ValidateRho(grid.rho[i]);
    if (status.ok()) {
      largest = std::fmax(largest, grid.rho[i]);
      smallest = std::fmin(smallest, grid.rho[i]);
    }
    if (!status.ok()) found->push_back({At("rho", i), std::string(status.message())});
  }
  for (size_t i = 0; i < grid.delta.size(); ++i) {
    const absl::Status status =
        largest > 0 ? ValidatePairDelta(largest, grid.delta[i]) : ValidateSomeDelta(grid.delta[i]);
    if (!status.ok()) {
      found->push_back({At("delta", i), std::string(status.message())});
    } else if (largest > 0 && !HasFiniteTimes(smallest, grid.delta[i])) {
      found->push_back({At("delta", i), absl::StrCat("delta is ", NumberText(grid.delta[i]),
                                                     ", too small: the mean free time leaves the "
                                                     "range of double")});
    }
  }
}

double PointsAskedFor(const Grid& grid) {
  double points = 1;
  for (const size_t size :
       {grid.rho.size(), grid.delta.size(), grid.epsilon.size(), grid.exponent.size()}) {
    if (size != 0) points *= static_cast<double>(size);
  }
  return points;
}

void CheckPointCount(const Grid& grid, Found* found) {
  const double points = PointsAskedFor(grid);
  if (points <= static_cast<double>(kMaxPoints)) return;
  found->push_back(
      {"grid", absl::StrFormat("has %.0f points; permitted: 1 to %d", points, kMaxPoints)});
}

void CheckGrid(const EnsembleSpec& spec, Found* found) {
  CheckUse(spec.experiment, "rho", Use::kNeeded, spec.grid.rho.size(), found);
  CheckUse(spec.experiment, "delta", Use::kNeeded, spec.grid.delta.size(), found);
  CheckUse(spec.experiment, "epsilon", UseOfEpsilon(spec.experiment), spec.grid.epsilon.size(),
           found);
  CheckUse(spec.experiment, "exponent", UseOfExponent(spec.experiment), spec.grid.exponent.size(),
           found);
  CheckUse(spec.experiment, "cells", Use::kNone, spec.grid.cells.size(), found);
  CheckPointCount(spec.grid, found);
}

void CheckValues(const Grid& grid, Found* found) {
  if (PointsAskedFor(grid) > static_cast<double>(kMaxPoints)) return;  // said already
  CheckGeometry(grid, found);
  CheckRange("epsilon", grid.epsilon, 0, 0.5, found);
  CheckRange("exponent", grid.exponent, 0, kMaxExponent, found);
}

void CheckCount(absl::string_view field, const std::optional<int64_t>& count, Found* found) {
  if (!count || (*count >= 1 && *count <= kMaxSamples)) return;
  found->push_back({absl::StrCat("target.", field),
                    absl::StrFormat("is %d; permitted: 1 to %d", *count, kMaxSamples)});
}

void CheckTargetKind(const EnsembleSpec& spec, Found* found) {
  const Experiment experiment = spec.experiment;
  const bool counts_collisions =
      experiment == Experiment::kEquilibrium || experiment == Experiment::kMarkovProperty;
  if (counts_collisions && spec.target.samples) {
    found->push_back({"target.samples",
                      absl::StrCat(Name(experiment), " counts collisions; use target.collisions")});
  }
  if (!counts_collisions && experiment != Experiment::kEnergyRelaxation && spec.target.collisions) {
    found->push_back({"target.collisions",
                      absl::StrCat(Name(experiment), " counts samples; use target.samples")});
  }
}

// Returns whose mean has no error to reach.
bool StartsFromRestingPiston(const EnsembleSpec& spec) {
  return UseOfEpsilon(spec.experiment) == Use::kNeeded &&
         std::find(spec.grid.epsilon.begin(), spec.grid.epsilon.end(), 0.0) !=
             spec.grid.epsilon.end();
}

// Whether the point is answered without sampling.
bool NeedsNoSamples(const EnsembleSpec& spec) {
  return spec.model == Model::kClosedForm ||
         (spec.model == Model::kAuto && !spec.verify && HasClosedForm(spec.experiment));
}

void CheckTolerance(const EnsembleSpec& spec, Found* found) {
  if (!spec.target.tolerance) return;
  if (!(*spec.target.tolerance > 0 && *spec.target.tolerance < 1)) {
    found->push_back({"target.tolerance", absl::StrCat("is ", NumberText(*spec.target.tolerance),
                                                       "; permitted: 0 < tolerance < 1")});
  }
  if (StartsFromRestingPiston(spec) && !NeedsNoSamples(spec)) {
    found->push_back({"target.tolerance",
                      "cannot be reached at epsilon = 0, where the return time has no variance; "
                      "permitted: samples"});
  }
  if (spec.experiment == Experiment::kMarkovProperty) {
    found->push_back({"target.tolerance",
                      "is relative, and markov-property measures what tends to 0; permitted: "
                      "collisions, budget"});
  }
}

void CheckBudget(const Target& target, Found* found) {
  if (!target.budget_seconds) return;
  if (!(*target.budget_seconds > 0 && *target.budget_seconds <= kMaxBudgetSeconds)) {
    found->push_back({"target.budget", absl::StrCat("is ", NumberText(*target.budget_seconds),
                                                    " s; permitted: 0 < budget <= ",
                                                    NumberText(kMaxBudgetSeconds), " s")});
  }
  if (target.samples || target.collisions) {
    found->push_back({"target.budget",
                      "stands beside a number of samples or collisions; "
                      "permitted: alone, or with a tolerance"});
  }
}

void CheckTarget(const EnsembleSpec& spec, Found* found) {
  const Target& target = spec.target;
  const int kinds =
      target.samples.has_value() + target.collisions.has_value() + target.tolerance.has_value();
  if (kinds > 1) found->push_back({"target", "more than one kind is set; permitted: one"});
  CheckTargetKind(spec, found);
  CheckCount("samples", target.samples, found);
  CheckCount("collisions", target.collisions, found);
  CheckTolerance(spec, found);
  CheckBudget(target, found);
}

// A relative error of what passes through 0.
void CheckToleranceOfDecay(const EnsembleSpec& spec, Found* found) {
  if (spec.experiment != Experiment::kEnergyRelaxation || !spec.target.tolerance) return;
  if (PointsAskedFor(spec.grid) > static_cast<double>(kMaxPoints)) return;  // said already
  for (size_t i = 0; i < spec.grid.epsilon.size(); ++i) {
    if (HasRelaxationTime(spec.grid.epsilon[i])) continue;
    found->push_back({At("epsilon", i),
                      absl::StrCat("is ", NumberText(spec.grid.epsilon[i]),
                                   ", from where the mean energy has no relaxation time; permitted "
                                   "with a tolerance: [0, ",
                                   kNoDecayFrom, "] or [", kNoDecayTo, ", 0.5]")});
  }
}

std::string AnsweringModels(Experiment experiment) {
  std::vector<absl::string_view> names;
  for (const Model model : kAllModels) {
    if (Answers(model, experiment)) names.push_back(Name(model));
  }
  return absl::StrJoin(names, ", ");
}

void CheckModel(const EnsembleSpec& spec, Found* found) {
  if (!Answers(spec.model, spec.experiment)) {
    found->push_back({"model", absl::StrCat("is ", Name(spec.model), ", which cannot answer ",
                                            Name(spec.experiment),
                                            "; permitted: ", AnsweringModels(spec.experiment))});
  }
  if (spec.precision == Precision::kSingle && spec.model != Model::kAuto &&
      spec.model != Model::kBilliard) {
    found->push_back({"precision", absl::StrCat("is single; permitted with model ",
                                                Name(spec.model), ": double")});
  }
  if (spec.verify && spec.model != Model::kAuto) {
    found->push_back({"verify", absl::StrCat("is set, and model ", Name(spec.model),
                                             " is given; permitted with model auto")});
  }
}

}  // namespace

std::vector<FieldViolation> Violations(const EnsembleSpec& spec) {
  Found found;
  if (spec.experiment == Experiment::kUnspecified) {
    found.push_back({"experiment",
                     "is missing; permitted: equilibrium, conditional-mean-free-time, first-hit, "
                     "energy-relaxation, markov-property"});
  } else {
    CheckGrid(spec, &found);
    CheckTarget(spec, &found);
    CheckModel(spec, &found);
    CheckToleranceOfDecay(spec, &found);
  }
  CheckValues(spec.grid, &found);
  return found;
}

}  // namespace ballpiston
