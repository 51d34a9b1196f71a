// A question at one point, for a machine: what the choice of the model, the ladder and the refusals
// need to know of it. For the sources of this folder only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "core/billiard/billiard_domain.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/experiment/pair_experiment.h"
#include "core/model_choice/ladder.h"
#include "core/model_choice/sampling_cost.h"

namespace ballpiston {

inline std::string Rounded(double x) { return absl::StrFormat("%.2g", x); }

// One point's question.
class Question {
 public:
  Question(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine)
      : spec_(OnePointSpec(spec, point, spec.model)), point_(point), machine_(machine) {}

  const EnsembleSpec& spec() const { return spec_; }
  const PointParameters& point() const { return point_; }
  const Target& target() const { return spec_.target; }
  const AimedEstimate& aim() const { return AimOf(spec_); }
  bool HasLimit() const { return aim().limit_error != nullptr; }
  // The upper bound of the limit's error, if it is known.
  std::optional<double> LimitError() const { return aim().LimitErrorAt(point_); }
  bool IsSoundForBilliard() const { return ballpiston::IsSoundForBilliard(spec_, point_); }
  // The cheapest model that answers in the limit. Requires HasLimit.
  Model ModelOfLimit() const { return *std::ranges::find_if(aim().models, IsOfTheLimit); }
  // Whether this error of the limit is within the tolerance. If the limit's model takes samples,
  // its error must be within half of the tolerance, so that the scatter is the larger part.
  bool IsWithinTolerance(double limit_error) const {
    const double share = TakesSamples(ModelOfLimit()) ? 2 : 1;
    return !target().tolerance || limit_error <= *target().tolerance / share;
  }

  // The experiment, or the estimate if it is not the experiment's default.
  absl::string_view subject() const {
    const bool is_default = &aim() == &spec_.experiment->aims.front();
    return is_default ? spec_.experiment->name : aim().name;
  }

  // The model's error without the statistical error: the bound of the limit's error, or the error
  // of the billiard's precision. Empty if the error is unknown, or if the first estimate has no
  // relative error.
  std::optional<double> ModelErrorOf(Model model) const {
    if (IsOfTheLimit(model)) return LimitError();
    const bool is_single = EngineFor(By(model)) == Engine::kLanesSingle;
    if (model == Model::kClosedForm || !is_single) return 0.0;
    if (!HasRelativeError()) return std::nullopt;
    return kSinglePrecisionError;
  }

  SamplingCost CostBy(Model model) const {
    return CostOfSampling(By(model), point_, machine_.rates);
  }
  // The seconds of processor time until all workers have their first samples.
  double SecondsOfTheFirst(Model model) const {
    return TakesSamples(model) ? CostBy(model).OfTheFirst(machine_.workers) : 0;
  }
  // The same by the model that answers: the least budget.
  double SecondsOfTheFirst() const {
    if (spec_.model != Model::kAuto) return SecondsOfTheFirst(spec_.model);
    if (!IsSoundForBilliard()) return SecondsOfTheFirst(ModelOfLimit());
    const double by_billiard = SecondsOfTheFirst(Model::kBilliard);
    if (!HasLimit() || !HasRelativeError()) return by_billiard;
    const bool is_within =
        !target().tolerance || IsWithinTolerance(LimitError().value_or(HUGE_VAL));
    return is_within ? std::min(by_billiard, SecondsOfTheFirst(ModelOfLimit())) : by_billiard;
  }
  double MemoryBy(Model model) const { return MemoryOf(By(model), point_, machine_.workers); }

  // The number of samples that the target requires from a model that samples, without those of a
  // warm-up.
  double SamplesBy(Model model) const {
    const auto experiment = PointExperiment::Create(By(model), 0);
    const ChunkPlan& plan = experiment->plan();
    double samples =
        static_cast<double>(plan.SamplesBefore(experiment->expected_chunks()) - plan.warm_up());
    if (target().budget_seconds) samples = std::min(samples, SamplesInBudget(model));
    return samples;
  }

  // 0 if the budget ends before the first samples; infinite for the spectrum, which needs none.
  double SamplesInBudget(Model model) const {
    if (!TakesSamples(model)) return std::numeric_limits<double>::infinity();
    const double seconds = BudgetOfAPoint(spec_, machine_.workers);
    return CostBy(model).SamplesIn(seconds, machine_.workers);
  }

  Scatter ScatterBy(Model model) const { return aim().scatter(model, point_); }
  bool HasRelativeError() const { return std::isfinite(ScatterBy(Model::kBilliard).error); }

  // The statistical error when the budget is used up; 0 for the spectrum, which has no samples.
  double ErrorInBudget(Model model) const {
    return TakesSamples(model) ? ScatterBy(model).ErrorOf(SamplesInBudget(model)) : 0;
  }

 private:
  EnsembleSpec By(Model model) const { return OnePointSpec(spec_, point_, model); }

  EnsembleSpec spec_;  // of this point alone
  PointParameters point_;
  Machine machine_;
};

}  // namespace ballpiston
