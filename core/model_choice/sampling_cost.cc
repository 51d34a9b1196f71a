#include "core/model_choice/sampling_cost.h"

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {
namespace {

// In lanes only the ball's wall hits are events; the reference has one for each hit and collision.
double WallHits(Engine engine, const SampleWork& work) {
  if (engine != Engine::kReference) return work.ball_wall;
  return work.ball_wall + work.piston_wall + work.collisions + work.starts;
}

}  // namespace

double SecondsPerSample(const EnsembleSpec& spec, const PointParameters& point,
                        const MachineRates& rates) {
  const Model model = Sampled(spec.model);
  const SampleWork work = spec.experiment->work(model, point);
  const Engine engine = EngineFor(spec);
  const EngineRate& rate = rates.Of(engine);
  return WallHits(engine, work) * rate.wall_hit + work.collisions * rate.collision +
         work.starts * rate.sample + work.jumps * rates.jump;
}

}  // namespace ballpiston
