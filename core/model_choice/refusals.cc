// The violations of ladder.h: what the answering model or the machine cannot do.
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_shape.h"
#include "core/model_choice/ladder.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

constexpr double kClosedFormError = kMeanFreeTimeRelativeError + kConditionalRateRelativeError;

// Not below x: rounding to two digits lowers a number by at most 4.8 %.
std::string RoundedUp(double x) { return Rounded(1.05 * x); }

// The model that is expected to answer, without pilots.
Model ExpectedModel(const EnsembleSpec& spec, const PointParameters& point) {
  if (spec.model != Model::kAuto) return spec.model;
  return ChooseAnswer(spec, point, Machine(), PredictedPilot)->model;
}

// The largest model error of any point, if a pilot can check it. For a model that samples, at least
// the statistical error of the largest permitted number of samples.
double LeastTolerance(const EnsembleSpec& spec) {
  if (IsAnsweredByClosedForm(spec)) return kClosedFormError;
  double least = 0;
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    const Question question(spec, point, Machine());
    const Model model = ExpectedModel(spec, point);
    if (model != Model::kMarkov || question.HasPilots()) {
      least = std::max(least, question.ModelErrorOf(model).value_or(0));
    }
    if (!TakesSamples(model)) continue;
    const double sampled = question.ScatterBy(model).ErrorOf(static_cast<double>(kMaxSamples));
    if (std::isfinite(sampled)) least = std::max(least, sampled);
  }
  return least;
}

// The names and values of the parameters of a point.
std::string ParametersText(const PointParameters& point) {
  std::string text;
  for (const Parameter* parameter : kParameters) {
    const auto& value = point.Find(*parameter);
    if (!value) continue;
    absl::StrAppend(&text, text.empty() ? "" : ", ", parameter->name, " = ",
                    parameter == &kCells ? Text(ShapeOf(*value)) : NumberText(*value));
  }
  return text;
}

// A point where a relative error is out of reach: of an estimate that has none, or because the
// largest permitted number of samples has no error. The first one.
std::vector<FieldViolation> PointsWithoutAnError(const EnsembleSpec& spec) {
  const AimedEstimate& aim = AimOf(spec);
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    const Model model = ExpectedModel(spec, point);
    if (model == Model::kClosedForm) continue;
    const Scatter scatter = aim.scatter(model, point);
    const double needed = TakesSamples(model) ? scatter.SamplesForAnError() : 0;
    const bool has_error = std::isfinite(scatter.error) && std::isfinite(needed);
    if (has_error && needed <= static_cast<double>(kMaxSamples)) continue;
    const std::string reason =
        has_error ? absl::StrFormat(
                        "an error needs %.2g samples, because the events that determine "
                        "the mean are rare; permitted in this case: samples, up to %d",
                        needed, kMaxSamples)
                  : absl::StrCat("no number of samples gives ", aim.name,
                                 " a relative error: ", aim.no_error);
    return {{"target.tolerance",
             absl::StrFormat("is %s, but at %s %s", NumberText(*spec.target.tolerance),
                             ParametersText(point), reason)}};
  }
  return {};
}

FieldViolation TooLong(const EnsembleSpec& spec, const PointParameters& point, double seconds) {
  const Target& target = spec.target;
  std::string field = "target.samples";
  std::string given = absl::StrCat("is ", kDefaultSamples, " by default");
  if (target.samples) given = absl::StrCat("is ", *target.samples);
  if (target.collisions) {
    field = "target.collisions", given = absl::StrCat("is ", *target.collisions);
  }
  if (target.tolerance) {
    field = "target.tolerance", given = absl::StrCat("is ", NumberText(*target.tolerance));
  }
  return {field,
          absl::StrFormat("%s, which takes about %.1g s of one core at %s; permitted: up to %.0g s",
                          given, seconds, ParametersText(point), kMostSeconds)};
}

}  // namespace

std::vector<FieldViolation> TimeViolations(const EnsembleSpec& spec) {
  if (NeedsNoSamples(spec) || spec.target.budget_seconds) return {};
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    // Without a tolerance AUTO takes samples of the billiard.
    const Model model = spec.target.tolerance ? ExpectedModel(spec, point) : Sampled(spec.model);
    if (!TakesSamples(model)) continue;
    const double seconds = NominalSeconds(OnePointSpec(spec, point, model), point);
    if (!(seconds <= kMostSeconds)) return {TooLong(spec, point, seconds)};
  }
  return {};
}

namespace {

std::string Megabytes(double bytes) { return absl::StrFormat("%.0f MB", std::ceil(bytes / 1e6)); }

// Only gases need much memory, and only their shape matters.
void CheckMemory(const EnsembleSpec& spec, const Machine& machine,
                 std::vector<FieldViolation>& found) {
  const std::vector<double>& cells = spec.grid[kCells];
  for (size_t i = 0; i < cells.size(); ++i) {
    PointParameters point = PointAt(spec, 0);
    point.Set(kCells, cells[i]);
    const double needed = MemoryOf(spec, point, 1);
    if (needed <= machine.memory) continue;
    found.push_back(
        {absl::StrFormat("grid.cells[%d]", i),
         absl::StrFormat("is %s, which needs %s of memory; permitted here: up to %s",
                         Text(ShapeOf(cells[i])), Megabytes(needed), Megabytes(machine.memory))});
  }
}

void CheckBudget(const EnsembleSpec& spec, const Machine& machine,
                 std::vector<FieldViolation>& found) {
  if (!spec.target.budget_seconds || NeedsNoSamples(spec)) return;
  const double budget = BudgetOfAPoint(spec, machine.workers);
  double least = 0;  // processor time of a point
  for (size_t i = 0; i < PointCount(spec); ++i) {
    least = std::max(least, Question(spec, PointAt(spec, i), machine).SecondsOfTheFirst());
  }
  if (least <= budget) return;
  const double seconds = *spec.target.budget_seconds * least / budget;
  const auto points = static_cast<int64_t>(PointCount(spec));
  found.push_back(
      {"target.budget",
       absl::StrFormat("is %s s%s, which ends before the first samples are complete; permitted on "
                       "this server: budget >= %s s",
                       NumberText(*spec.target.budget_seconds),
                       points == 1 ? "" : absl::StrFormat(" for %d points", points),
                       RoundedUp(seconds))});
}

}  // namespace

std::vector<FieldViolation> MachineViolations(const EnsembleSpec& spec, const Machine& machine) {
  std::vector<FieldViolation> found;
  CheckMemory(spec, machine, found);
  CheckBudget(spec, machine, found);
  return found;
}

std::vector<FieldViolation> DomainViolations(const EnsembleSpec& spec) {
  std::vector<FieldViolation> found;
  if (spec.model != Model::kAuto) return found;
  for (size_t i = 0; i < PointCount(spec) && found.empty(); ++i) {
    const PointParameters point = PointAt(spec, i);
    if (IsSoundForBilliard(spec, point) || !IsABilliard(ExpectedModel(spec, point))) continue;
    EnsembleSpec by_billiard = spec;
    by_billiard.model = Model::kBilliard;
    CheckBilliardDomain(by_billiard, found);
  }
  return found;
}

std::vector<FieldViolation> ToleranceViolations(const EnsembleSpec& spec) {
  if (!spec.target.tolerance) return {};
  if (std::vector<FieldViolation> found = PointsWithoutAnError(spec); !found.empty()) return found;
  const double tolerance = *spec.target.tolerance, least = LeastTolerance(spec);
  if (!(tolerance < least)) return {};
  absl::string_view other;
  if (IsOfTheLimit(spec.model)) other = ", or model auto or billiard";
  if (spec.precision == Precision::kSingle) other = ", or precision double";
  const std::string permitted = least < 1 ? absl::StrCat("tolerance >= ", RoundedUp(least))
                                          : "samples or a budget in place of a tolerance";
  return {{"target.tolerance",
           absl::StrCat("is ", NumberText(tolerance), ", below what model ", Name(spec.model),
                        " can reach; permitted: ", permitted, other)}};
}

}  // namespace ballpiston
