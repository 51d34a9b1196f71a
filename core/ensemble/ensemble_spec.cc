#include "core/ensemble/ensemble_spec.h"

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {

size_t PointCount(const EnsembleSpec& spec) { return static_cast<size_t>(spec.grid.PointCount()); }

PointParameters PointAt(const EnsembleSpec& spec, size_t index) {
  PointParameters point = spec.grid.PointAt(index);
  if (spec.experiment == nullptr) return point;
  for (const ParameterUse& use : spec.experiment->parameters) {
    if (use.default_value && !point.Find(*use.parameter)) {
      point.Set(*use.parameter, use.default_value);
    }
  }
  return point;
}

EnsembleSpec OnePointSpec(const EnsembleSpec& spec, const PointParameters& point, Model model) {
  EnsembleSpec one = {.experiment = spec.experiment,
                      .target = spec.target,
                      .seed = spec.seed,
                      .model = model,
                      .precision = spec.precision,
                      .verify = spec.verify};  // a copy of the grid would be large
  for (const Parameter* parameter : kParameters) {
    if (const auto& value = point.Find(*parameter)) one.grid[*parameter] = {*value};
  }
  if (one.target.budget_seconds) *one.target.budget_seconds /= spec.grid.PointCount();
  return one;
}

bool NeedsNoSamples(const EnsembleSpec& spec) {
  if (spec.model != Model::kAuto) return !TakesSamples(spec.model);
  return !spec.verify && AimOf(spec).HasClosedForm();
}

Engine EngineFor(const EnsembleSpec& spec) {
  if (spec.model == Model::kBilliardReference) return Engine::kReference;
  return spec.precision == Precision::kSingle ? Engine::kLanesSingle : Engine::kLanes;
}

}  // namespace ballpiston
