// Finds the errors of a specification itself, field by field.
#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/arithmetic/number_text.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/experiment_kind.h"

namespace ballpiston {
namespace {

using Found = std::vector<FieldViolation>;

std::string ListOf(const Parameter& parameter) { return absl::StrCat("grid.", parameter.name); }

const ParameterUse* UseOf(const ExperimentKind& experiment, const Parameter& parameter) {
  for (const ParameterUse& use : experiment.parameters) {
    if (use.parameter == &parameter) return &use;
  }
  return nullptr;
}

std::string Counted(size_t count, absl::string_view noun) {
  return absl::StrCat(count, " ", noun, count == 1 ? "" : "s");
}

void CheckUse(const ExperimentKind& experiment, const Parameter& parameter, size_t size,
              Found& found) {
  const ParameterUse* use = UseOf(experiment, parameter);
  if (use == nullptr && size != 0) {
    found.push_back({ListOf(parameter), absl::StrCat("has ", Counted(size, "value"), "; ",
                                                     experiment.name, " does not use this list")});
  }
  if (use != nullptr && use->needed && !use->default_value && size == 0) {
    found.push_back({ListOf(parameter),
                     absl::StrCat("is empty; ", experiment.name, " needs at least one value")});
  }
}

bool HasTooManyPoints(const Grid& grid) {
  return grid.PointCount() > static_cast<double>(kMaxPoints);
}

size_t RowsOf(const Grid& grid) { return grid[*grid.FirstColumn()].size(); }

bool IsWrongColumn(const Grid& grid, const Parameter& parameter) {
  const size_t size = grid[parameter].size();
  return grid.IsColumn(parameter) && (size == 0 || size != RowsOf(grid));
}

bool HasWrongColumn(const Grid& grid) {
  return std::ranges::any_of(
      kParameters, [&grid](const Parameter* parameter) { return IsWrongColumn(grid, *parameter); });
}

// Whether PointAt may be called, for a number of points that is permitted.
bool HasPoints(const Grid& grid) { return !HasWrongColumn(grid) && !HasTooManyPoints(grid); }

void CheckPointCount(const Grid& grid, Found& found) {
  if (!HasTooManyPoints(grid)) return;
  found.push_back({"grid", absl::StrFormat("has %.0f points; permitted: 1 to %d", grid.PointCount(),
                                           kMaxPoints)});
}

void CheckTable(const Grid& grid, Found& found) {
  for (const Parameter* parameter : kParameters) {
    if (!IsWrongColumn(grid, *parameter)) continue;
    found.push_back(
        {ListOf(*parameter),
         absl::StrCat("has ", Counted(grid[*parameter].size(), "value"), ", but the table has ",
                      Counted(std::max<size_t>(RowsOf(grid), 1), "row"),
                      "; permitted: a value a row")});
  }
}

void CheckLists(const EnsembleSpec& spec, Found& found) {
  CheckTable(spec.grid, found);
  for (const Parameter* parameter : kParameters) {
    CheckUse(*spec.experiment, *parameter, spec.grid[*parameter].size(), found);
  }
  CheckPointCount(spec.grid, found);
}

void CheckEachValue(const Parameter& parameter, const std::vector<double>& values, Found& found) {
  for (size_t i = 0; i < values.size(); ++i) {
    const absl::Status status = parameter.Validate(values[i]);
    if (status.ok()) continue;
    found.push_back(
        {absl::StrFormat("%s[%d]", ListOf(parameter), i), std::string(status.message())});
  }
}

void CheckValues(const EnsembleSpec& spec, Found& found) {
  if (!HasPoints(spec.grid)) return;  // already reported
  for (const Parameter* parameter : kParameters) {
    CheckEachValue(*parameter, spec.grid[*parameter], found);
  }
}

// Combinations of values are checked if each list and each value is permitted.
void CheckGrid(const EnsembleSpec& spec, Found& found) {
  if (spec.experiment != nullptr) CheckLists(spec, found);
  CheckValues(spec, found);
  if (spec.experiment != nullptr && found.empty()) spec.experiment->check_grid(spec, found);
}

void CheckCount(absl::string_view field, const std::optional<int64_t>& count, Found& found) {
  if (!count || (*count >= 1 && *count <= kMaxSamples)) return;
  found.push_back({absl::StrCat("target.", field),
                   absl::StrFormat("is %d; permitted: 1 to %d", *count, kMaxSamples)});
}

void CheckTolerance(const EnsembleSpec& spec, Found& found) {
  if (!spec.target.tolerance) return;
  if (*spec.target.tolerance > 0 && *spec.target.tolerance < 1) return;
  found.push_back({"target.tolerance", absl::StrCat("is ", NumberText(*spec.target.tolerance),
                                                    "; permitted: 0 < tolerance < 1")});
}

std::string NamesOfAims(const ExperimentKind& experiment, Model model) {
  std::vector<absl::string_view> names;
  for (const AimedEstimate& aim : experiment.aims) {
    if (aim.IsAnsweredBy(model)) names.push_back(aim.name);
  }
  return absl::StrJoin(names, ", ");
}

std::string NamesOf(std::span<const Model> models) {
  return absl::StrCat(Name(Model::kAuto), ", ",
                      absl::StrJoin(models, ", ", [](std::string* out, Model model) {
                        absl::StrAppend(out, Name(model));
                      }));
}

// If the model answers no estimate of the experiment, only the field `model` is a violation.
void CheckEstimate(const EnsembleSpec& spec, Found& found) {
  const ExperimentKind& experiment = *spec.experiment;
  const AimedEstimate* const aim = experiment.FindAim(spec.target.estimate);
  if (aim == nullptr) {
    found.push_back({"target.estimate",
                     absl::StrCat("is ", spec.target.estimate, "; permitted with ", experiment.name,
                                  ": ", NamesOfAims(experiment, Model::kAuto))});
  } else if (!aim->IsAnsweredBy(spec.model) && experiment.IsAnsweredBy(spec.model)) {
    found.push_back(
        {"target.estimate",
         absl::StrCat("is ", aim->name, ", which model ", Name(spec.model),
                      " cannot answer; permitted: ", NamesOfAims(experiment, spec.model),
                      ", or model ", NamesOf(aim->models))});
  }
}

void CheckBudget(const Target& target, Found& found) {
  if (!target.budget_seconds) return;
  if (!(*target.budget_seconds > 0 && *target.budget_seconds <= kMaxBudgetSeconds)) {
    found.push_back({"target.budget", absl::StrCat("is ", NumberText(*target.budget_seconds),
                                                   " s; permitted: 0 < budget <= ",
                                                   NumberText(kMaxBudgetSeconds), " s")});
  }
  if (target.samples || target.collisions) {
    found.push_back({"target.budget",
                     "is set together with a number of samples or collisions; "
                     "permitted: alone, or with a tolerance"});
  }
}

// A number of collisions may need more samples than are permitted: a replica of a gas may have
// fewer than one collision.
void CheckSamplesOfCollisions(const EnsembleSpec& spec, Found& found) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < PointCount(spec); ++i) {
    least = std::min(least, ForecastOf(spec, PointAt(spec, i)).collisions);
  }
  const double most = std::floor(least * static_cast<double>(kMaxSamples));
  if (static_cast<double>(*spec.target.collisions) <= most) return;
  const std::string permitted = most < 1 ? "target.samples" : absl::StrFormat("1 to %.0f", most);
  found.push_back(
      {"target.collisions",
       absl::StrFormat("is %d, but a sample has %.3g collisions, and at most %d samples can be "
                       "taken; permitted: %s",
                       *spec.target.collisions, least, kMaxSamples, permitted)});
}

void CheckTarget(const EnsembleSpec& spec, Found& found) {
  const Target& target = spec.target;
  const int kinds =
      target.samples.has_value() + target.collisions.has_value() + target.tolerance.has_value();
  if (kinds > 1) found.push_back({"target", "more than one kind is set; permitted: one"});
  CheckCount("samples", target.samples, found);
  CheckCount("collisions", target.collisions, found);
  CheckEstimate(spec, found);
  CheckTolerance(spec, found);
  CheckBudget(target, found);
}

void CheckModel(const EnsembleSpec& spec, Found& found) {
  if (!spec.experiment->IsAnsweredBy(spec.model)) {
    found.push_back({"model", absl::StrCat("is ", Name(spec.model), ", which cannot answer ",
                                           spec.experiment->name,
                                           "; permitted: ", NamesOf(spec.experiment->models()))});
  }
  if (spec.precision == Precision::kSingle && spec.model != Model::kAuto &&
      spec.model != Model::kBilliard) {
    found.push_back({"precision", absl::StrCat("is single; permitted with model ", Name(spec.model),
                                               ": double")});
  }
  if (spec.verify && spec.model != Model::kAuto) {
    found.push_back({"verify", absl::StrCat("is set, and model ", Name(spec.model),
                                            " is given; permitted with model auto")});
  }
}

std::string ExperimentNames() {
  return absl::StrJoin(AllExperiments(), ", ", [](std::string* out, const ExperimentKind* kind) {
    absl::StrAppend(out, kind->name);
  });
}

}  // namespace

std::vector<FieldViolation> Violations(const EnsembleSpec& spec) {
  Found found;
  CheckGrid(spec, found);
  if (spec.experiment == nullptr) {
    found.push_back({"experiment", absl::StrCat("is missing; permitted: ", ExperimentNames())});
    return found;
  }
  CheckTarget(spec, found);
  CheckModel(spec, found);
  if (found.empty() && spec.target.collisions && !NeedsNoSamples(spec)) {
    CheckSamplesOfCollisions(spec, found);
  }
  return found;
}

}  // namespace ballpiston
