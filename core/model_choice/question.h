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
#include "core/experiment/all_experiments.h"
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
  // Whether a bound of the limit's error is known.
  bool HasLimitError() const { return HasLimit() && aim().limit_error->is_known(point_); }
  // Whether pilots can check the bound. They are runs of energy-relaxation. In a gas a pilot would
  // take as long as the billiard's answer.
  bool HasPilots() const { return HasLimitError() && spec_.experiment == &kEnergyRelaxation; }
  double ExpectedLimitError() const { return aim().limit_error->expected(point_); }
  bool IsSoundForBilliard() const { return ballpiston::IsSoundForBilliard(spec_, point_); }
  Model ModelOfLimit() const { return aim().limit_error->model; }
  // Whether the limit's error can be judged, and is not beyond the tolerance.
  bool MayBeAnsweredByLimit() const {
    return HasLimitError() && HasRelativeError() &&
           (!target().tolerance || aim().limit_error->IsWithin(*target().tolerance, point_));
  }

  // The experiment, or the estimate if it is not the experiment's default.
  absl::string_view subject() const {
    const bool is_default = &aim() == &spec_.experiment->aims.front();
    return is_default ? spec_.experiment->name : aim().name;
  }

  // The model error of a billiard model: its error without the statistical error. Empty if the
  // first estimate has no relative error.
  std::optional<double> ErrorOfPrecision(Model model) const {
    if (EngineFor(By(model)) != Engine::kLanesSingle) return 0.0;
    if (!HasRelativeError()) return std::nullopt;
    return kSinglePrecisionError;
  }

  SamplingCost CostBy(Model model) const {
    return CostOfSampling(By(model), point_, machine_.rates);
  }
  double SecondsOf(Model model, double samples) const {
    return CostBy(model).Of(samples, machine_.workers) +
           spec_.experiment->summary * machine_.rates.jump;
  }
  double ThreadsFor(Model model, double samples) const {
    return CostBy(model).ThreadsFor(samples, machine_.workers);
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
    return MayBeAnsweredByLimit() ? std::min(by_billiard, SecondsOfTheFirst(ModelOfLimit()))
                                  : by_billiard;
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

  // 0 if the budget ends before the first samples.
  double SamplesInBudget(Model model) const {
    const double seconds = BudgetOfAPoint(spec_, machine_.workers);
    return CostBy(model).SamplesIn(seconds, machine_.workers);
  }

  // Or needs none.
  bool LimitHasSamplesInBudget() const {
    return !TakesSamples(ModelOfLimit()) || SamplesInBudget(ModelOfLimit()) > 0;
  }

  double SamplesFor(double tolerance) const {
    return ballpiston::SamplesFor(tolerance, spec_, point_);
  }

  // Infinite if so many samples have no error.
  double ErrorOf(Model model, double samples) const {
    if (samples < aim().SamplesForAnError(model, point_)) {
      return std::numeric_limits<double>::infinity();
    }
    return aim().error(model, point_) / std::sqrt(samples);
  }
  bool HasRelativeError() const { return std::isfinite(aim().error(Model::kBilliard, point_)); }

  // The statistical error when the budget is used up; 0 for the spectrum, which has no samples.
  double ErrorInBudget(Model model) const {
    return model == Model::kSpectrum ? 0 : ErrorOf(model, SamplesInBudget(model));
  }

 private:
  EnsembleSpec By(Model model) const { return OnePointSpec(spec_, point_, model); }

  EnsembleSpec spec_;  // of this point alone
  PointParameters point_;
  Machine machine_;
};

}  // namespace ballpiston
