// The violations of ladder.h: what the answering model or the machine cannot do.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_shape.h"
#include "core/model_choice/ladder.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

// Not below x: rounding to two digits lowers a number by at most 4.8 %.
std::string RoundedUp(double x) { return Rounded(1.05 * x); }

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

// The answer at a point.
struct Expected {
  PointParameters point;
  Model model;
  Scatter scatter = {};  // if the spec has a tolerance
};

// A model is chosen only if the choice decides whether the point is refused. Without a tolerance
// AUTO answers by the billiard or without samples.
Expected ExpectedAt(const EnsembleSpec& spec, const PointParameters& point) {
  Expected expected = {point, Sampled(spec.model)};
  if (spec.model == Model::kAuto && (spec.target.tolerance || !IsSoundForBilliard(spec, point))) {
    expected.model = ChooseAnswer(spec, point, Machine()).model;
  }
  if (spec.target.tolerance && expected.model != Model::kClosedForm) {
    expected.scatter = AimOf(spec).scatter(expected.model, point);
  }
  return expected;
}

std::vector<FieldViolation> BeyondTheDomain(const EnsembleSpec& spec) {
  EnsembleSpec by_billiard = spec;
  by_billiard.model = Model::kBilliard;
  std::vector<FieldViolation> found;
  CheckBilliardDomain(by_billiard, found);
  return found;
}

// A violation if the estimate has no relative error, or if even the largest permitted number of
// samples is too small for an error.
std::optional<FieldViolation> WithoutAnError(const EnsembleSpec& spec, const Expected& expected) {
  const auto& [point, model, scatter] = expected;
  const double needed = TakesSamples(model) ? scatter.SamplesForAnError() : 0;
  const bool has_error = std::isfinite(scatter.error) && std::isfinite(needed);
  if (has_error && needed <= static_cast<double>(kMaxSamples)) return std::nullopt;
  const std::string reason =
      has_error ? absl::StrFormat(
                      "an error needs %.2g samples, because the events that determine "
                      "the mean are rare; permitted in this case: samples, up to %d",
                      needed, kMaxSamples)
                : absl::StrCat("no number of samples gives ", AimOf(spec).name,
                               " a relative error: ", AimOf(spec).no_error);
  return FieldViolation{"target.tolerance",
                        absl::StrFormat("is %s, but at %s %s", NumberText(*spec.target.tolerance),
                                        ParametersText(point), reason)};
}

// The least tolerance that can be reached: the model's error, which does not count for `markov`,
// and at least the statistical error of the largest permitted number of samples or the numerical
// error of a model without samples.
double LeastTolerance(const EnsembleSpec& spec, const Expected& expected) {
  const auto& [point, model, scatter] = expected;
  const Question question(spec, point, Machine());
  const double of_model = model == Model::kMarkov ? 0 : question.ModelErrorOf(model).value_or(0);
  const double of_samples = TakesSamples(model) ? scatter.ErrorOf(static_cast<double>(kMaxSamples))
                                                : AimOf(spec).numerical_error(point);
  return std::isfinite(of_samples) ? std::max(of_model, of_samples) : of_model;
}

FieldViolation BelowReach(const EnsembleSpec& spec, double least) {
  absl::string_view other;
  if (IsOfTheLimit(spec.model)) other = ", or model auto or billiard";
  if (spec.precision == Precision::kSingle) other = ", or precision double";
  // From here on RoundedUp writes 1, and a tolerance of 1 is not permitted.
  constexpr double kRoundsToOne = 0.995 / 1.05;
  const std::string permitted = least < kRoundsToOne
                                    ? absl::StrCat("tolerance >= ", RoundedUp(least))
                                    : "samples or a budget in place of a tolerance";
  return {"target.tolerance",
          absl::StrCat("is ", NumberText(*spec.target.tolerance), ", below what model ",
                       Name(spec.model), " can reach; permitted: ", permitted, other)};
}

// A number of samples or collisions with one significant digit that takes at most kMostSeconds; 0
// if there is none. The time has parts that do not grow with the number; therefore the first guess
// may be too large.
int64_t PermittedCount(EnsembleSpec spec, const PointParameters& point,
                       std::optional<int64_t> Target::*kind, double guess) {
  for (; guess >= 1; guess /= 2) {
    const double unit = std::pow(10, std::floor(std::log10(guess)));
    const auto count = static_cast<int64_t>(std::floor(guess / unit) * unit);
    spec.target.*kind = count;
    if (NominalSeconds(spec, point, HUGE_VAL) <= kMostSeconds) return count;
  }
  return 0;
}

// `spec` has one point.
FieldViolation TooLong(const EnsembleSpec& spec, const PointParameters& point, double seconds) {
  const Target& target = spec.target;
  const std::string reason = absl::StrFormat(
      ", which takes about %.1g s of one core at %s; permitted", seconds, ParametersText(point));
  const std::string limit = absl::StrFormat("%.0g s", kMostSeconds);
  if (target.tolerance) {
    return {"target.tolerance",
            absl::StrCat("is ", NumberText(*target.tolerance), reason, ": up to ", limit)};
  }
  const auto kind = target.collisions ? &Target::collisions : &Target::samples;
  const int64_t given = (target.*kind).value_or(kDefaultSamples);
  const int64_t permitted = PermittedCount(
      spec, point, kind, static_cast<double>(given) * std::min(1.0, kMostSeconds / seconds));
  return {target.collisions ? "target.collisions" : "target.samples",
          absl::StrCat("is ", given, target.*kind ? "" : " by default", reason, " there: ",
                       permitted == 0 ? "none, because even one takes longer than "
                                      : absl::StrCat("up to ", permitted, ", the number for "),
                       limit)};
}

}  // namespace

std::vector<FieldViolation> AnswerViolations(const EnsembleSpec& spec) {
  const std::optional<double>& tolerance = spec.target.tolerance;
  const bool takes_time = !NeedsNoSamples(spec) && !spec.target.budget_seconds;
  double least = 0;
  std::optional<FieldViolation> without_an_error, too_long;  // the first ones
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const Expected expected = ExpectedAt(spec, PointAt(spec, i));
    const auto& [point, model, scatter] = expected;
    if (model == Model::kClosedForm) {
      if (tolerance) least = std::max(least, AimOf(spec).numerical_error(point));
      continue;
    }
    if (spec.model == Model::kAuto && IsABilliard(model) && !IsSoundForBilliard(spec, point)) {
      return BeyondTheDomain(spec);
    }
    if (tolerance && !without_an_error) without_an_error = WithoutAnError(spec, expected);
    if (tolerance) least = std::max(least, LeastTolerance(spec, expected));
    if (!takes_time || !TakesSamples(model) || too_long) continue;
    const double needed = tolerance ? scatter.SamplesFor(*tolerance) : HUGE_VAL;
    const EnsembleSpec one = OnePointSpec(spec, point, model);
    const double seconds = NominalSeconds(one, point, needed);
    if (!(seconds <= kMostSeconds)) too_long = TooLong(one, point, seconds);
  }
  if (without_an_error) return {*without_an_error};
  if (tolerance && *tolerance < least) return {BelowReach(spec, least)};
  if (too_long) return {*too_long};
  return {};
}

namespace {

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
         absl::StrFormat("is %s, which needs %.0f MB of memory; permitted here: up to %.0f MB",
                         Text(ShapeOf(cells[i])), std::ceil(needed / 1e6),
                         std::floor(machine.memory / 1e6))});
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
  const std::string permitted =
      1.05 * seconds <= kMaxBudgetSeconds
          ? absl::StrCat("budget >= ", RoundedUp(seconds), " s")
          : absl::StrCat("no budget, because the first samples take longer than the largest one, ",
                         NumberText(kMaxBudgetSeconds), " s");
  found.push_back(
      {"target.budget",
       absl::StrFormat("is %s s%s, which ends before the first samples are complete; permitted on "
                       "this server: %s",
                       NumberText(*spec.target.budget_seconds),
                       points == 1 ? "" : absl::StrFormat(" for %d points", points), permitted)});
}

}  // namespace

std::vector<FieldViolation> MachineViolations(const EnsembleSpec& spec, const Machine& machine) {
  std::vector<FieldViolation> found;
  CheckMemory(spec, machine, found);
  CheckBudget(spec, machine, found);
  return found;
}

}  // namespace ballpiston
