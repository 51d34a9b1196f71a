#include "core/ensemble/experiment_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {

double Scatter::ErrorOf(double samples) const {
  if (samples < SamplesForAnError()) return std::numeric_limits<double>::infinity();
  return std::max(error / std::sqrt(samples), least);
}

double Scatter::SamplesForAnError() const { return kEventsForAnError / events; }

double Scatter::SamplesFor(double tolerance) const {
  const double ratio = error / tolerance;
  return std::max(ratio * ratio, SamplesForAnError());
}

bool AimedEstimate::IsAnsweredBy(Model model) const {
  return model == Model::kAuto || std::ranges::find(models, model) != models.end();
}

const AimedEstimate* ExperimentKind::FindAim(absl::string_view aim) const {
  if (aim.empty()) return &aims.front();
  const auto found = std::ranges::find(aims, aim, &AimedEstimate::name);
  return found == aims.end() ? nullptr : &*found;
}

const AimedEstimate& AimOf(const EnsembleSpec& spec) {
  return *spec.experiment->FindAim(spec.target.estimate);
}

Forecast ForecastOf(const EnsembleSpec& spec, const PointParameters& point) {
  return spec.experiment->forecast(Sampled(spec.model), point);
}

Scatter ScatterOf(const EnsembleSpec& spec, const PointParameters& point) {
  return AimOf(spec).scatter(Sampled(spec.model), point);
}

const ExperimentKind* FindExperiment(uint64_t number) {
  const auto found = std::ranges::find(AllExperiments(), number, &ExperimentKind::number);
  return found == AllExperiments().end() ? nullptr : *found;
}

double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads) {
  constexpr double kOfAnAnswer = 1e6;  // of a point without its samples
  if (NeedsNoSamples(spec)) return kOfAnAnswer;
  const Forecast forecast = ForecastOf(spec, point);
  const double used = std::min(static_cast<double>(threads),
                               static_cast<double>(SamplesAskedFor(spec.target, forecast)));
  const uint64_t further_orbits = (static_cast<uint64_t>(used) - 1) * ChunkFold::kOrbitsOfAThread;
  const uint64_t waiting_results = ChunkFold::WindowFor(PlanFor(spec, point), further_orbits);
  return kOfAnAnswer + static_cast<double>(waiting_results) * spec.experiment->memory_of_a_result +
         used * forecast.memory;
}

}  // namespace ballpiston
