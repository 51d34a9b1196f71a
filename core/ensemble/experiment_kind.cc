#include "core/ensemble/experiment_kind.h"

#include <algorithm>

#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/point_experiment.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

bool IsOneOf(std::span<const Model> models, Model model) {
  return model == Model::kAuto || std::find(models.begin(), models.end(), model) != models.end();
}

}  // namespace

bool LimitError::IsWithin(double tolerance, const PointParameters& point) const {
  return expected(point) <= tolerance / (TakesSamples(model) ? 2 : 1);
}

double AimedEstimate::SamplesForAnError(Model model, const PointParameters& point) const {
  return kEventsForAnError / (events == nullptr ? 1 : events(model, point));
}

bool AimedEstimate::IsAnsweredBy(Model model) const { return IsOneOf(models, model); }

bool ExperimentKind::IsAnsweredBy(Model model) const { return IsOneOf(models, model); }

const AimedEstimate* ExperimentKind::FindAim(absl::string_view aim) const {
  if (aim.empty()) return &aims.front();
  for (const AimedEstimate& known : aims) {
    if (known.name == aim) return &known;
  }
  return nullptr;
}

const AimedEstimate& AimOf(const EnsembleSpec& spec) {
  return *spec.experiment->FindAim(spec.target.estimate);
}

const ExperimentKind* FindExperiment(uint64_t number) {
  for (const ExperimentKind* kind : AllExperiments()) {
    if (kind->number == number) return kind;
  }
  return nullptr;
}

double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads) {
  constexpr double kOfAnAnswer = 1e6;  // of a point without its samples
  if (NeedsNoSamples(spec)) return kOfAnAnswer;
  const double used =
      std::min(static_cast<double>(threads), static_cast<double>(SamplesAskedFor(spec, point)));
  constexpr auto kWaitingResults = static_cast<double>(ChunkFold::kWindow);
  return kOfAnAnswer + kWaitingResults * spec.experiment->memory_of_a_result +
         used * spec.experiment->memory(Sampled(spec.model), point);
}

}  // namespace ballpiston
