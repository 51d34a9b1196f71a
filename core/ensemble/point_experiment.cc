#include "core/ensemble/point_experiment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/ensemble/experiment_kind.h"

namespace ballpiston {
namespace {

// The samples that are expected to reach the tolerance; infinite without one.
double SamplesExpected(const EnsembleSpec& spec, const PointParameters& point) {
  if (!spec.target.tolerance || !TakesSamples(Sampled(spec.model))) return HUGE_VAL;
  return ScatterOf(spec, point).SamplesFor(*spec.target.tolerance);
}

}  // namespace

ChunkPlan PlanFor(const EnsembleSpec& spec, const PointParameters& point) {
  if (!TakesSamples(Sampled(spec.model))) return ChunkPlan();
  const Forecast forecast = ForecastOf(spec, point);
  const uint64_t samples = SamplesAskedFor(spec.target, forecast);
  const double events = forecast.work.Events();
  if (forecast.trajectories) {
    return ChunkPlan(samples, EngineFor(spec), events, *forecast.trajectories);
  }
  return ChunkPlan(samples, EngineFor(spec), events, spec.experiment->samples_together);
}

double NominalSeconds(const EnsembleSpec& spec, const PointParameters& point, double samples) {
  const ChunkPlan plan = PlanFor(spec, point);
  return plan.SecondsFor(static_cast<double>(plan.SamplesBefore(plan.ChunksFor(samples))));
}

std::optional<double> Answer::ModelErrorOf(std::string_view name, bool is_first) const {
  if (is_first || model_error == 0) return model_error;
  const auto found = further_errors.find(name);
  return found == further_errors.end() ? std::nullopt : std::optional(found->second);
}

uint64_t SamplesAskedFor(const Target& target, const Forecast& forecast) {
  if (target.IsOpenEnded()) return kMaxSamples;
  if (!target.collisions) return static_cast<uint64_t>(target.samples.value_or(kDefaultSamples));
  const double samples = std::ceil(static_cast<double>(*target.collisions) / forecast.collisions);
  // More is a violation (validation.cc). The cast of a larger number would be undefined.
  return static_cast<uint64_t>(std::min(samples, static_cast<double>(kMaxSamples)));
}

PointExperiment::PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters)
    : PointExperiment(spec, parameters, PlanFor(spec, parameters)) {}

PointExperiment::PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters,
                                 const ChunkPlan& plan)
    : parameters_(parameters),
      answer_{.model = Sampled(spec.model)},
      engine_(EngineFor(spec)),
      plan_(plan),
      expected_samples_(SamplesExpected(spec, parameters)),
      aim_(&AimOf(spec)),
      tolerance_(spec.target.tolerance),
      random_{spec.seed, PointStream(spec, parameters)} {}

std::unique_ptr<const PointExperiment> PointExperiment::Create(const EnsembleSpec& spec,
                                                               size_t index) {
  return Create(spec, index, {.model = Sampled(spec.model)});
}

std::unique_ptr<const PointExperiment> PointExperiment::Create(const EnsembleSpec& spec,
                                                               size_t index, Answer answer) {
  const PointParameters point = PointAt(spec, index);
  const EnsembleSpec one = OnePointSpec(spec, point, answer.model);
  std::unique_ptr<PointExperiment> experiment = spec.experiment->create(one, point);
  experiment->answer_ = std::move(answer);
  return experiment;
}

void PointExperiment::SetMeasurements(BlockResult empty, std::vector<Measurement> table) {
  empty_ = std::move(empty);
  table_ = std::move(table);
  std::ranges::stable_partition(table_, [this](const Measurement& row) {
    return row.name == aim_->name || std::ranges::count(aim_->multiples, row.name) > 0;
  });
  if (TakesSamples(answer_.model)) return;
  for (Measurement& row : table_) row.reading = nullptr;
}

Estimate PointExperiment::FirstEstimate(const BlockResult& merged) const {
  return table_.front().Of(merged).value();
}

PointSummary PointExperiment::Summarize(const BlockResult& merged) const {
  PointSummary summary = {
      .samples = merged.samples, .estimates = EstimatesOf(table_, merged), .health = merged.health};
  AddDetails(merged, summary);
  if (summary.estimates.empty()) return summary;
  const Estimate& first = summary.estimates.front();
  if (!first.standard_error) summary.remarks.push_back(ReasonOfNoError(first.name));
  return summary;
}

std::string PointExperiment::ReasonOfNoError(absl::string_view estimate) const {
  return RemarkOnSamples(estimate, aim_->scatter(answer_.model, parameters_).SamplesForAnError());
}

double RelativeError(const Estimate& estimate) {
  if (estimate.standard_error == 0) return 0;
  if (!estimate.standard_error || estimate.value == 0) {
    return std::numeric_limits<double>::infinity();
  }
  return *estimate.standard_error / std::fabs(estimate.value);
}

// A value that is many times too large by chance, such as that of a current between nearly equal
// temperatures, has a small relative error. So a tolerance is not judged with few samples.
// With few trajectories the scatter is more often small by chance, so the tolerance is judged only
// from the expected number of samples on.
bool PointExperiment::ReachesTolerance(const BlockResult& merged) const {
  constexpr uint64_t kFewTrajectories = 32;
  const bool has_few = plan_.groups() > 0 && plan_.SamplesOfAStep() <= kFewTrajectories;
  const double least_share = has_few ? 1 : 0.25;
  const double measured =
      static_cast<double>(merged.samples) - static_cast<double>(plan_.warm_up());
  return tolerance_ && measured >= least_share * expected_samples_ &&
         RelativeError(FirstEstimate(merged)) <= *tolerance_;
}

}  // namespace ballpiston
