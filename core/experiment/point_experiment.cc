#include "core/experiment/point_experiment.h"

#include <cmath>

#include "core/experiment/conditional_mean_free_time.h"
#include "core/experiment/engine_choice.h"
#include "core/experiment/equilibrium.h"
#include "core/experiment/first_hit.h"
#include "core/experiment/point_stream.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

PointExperiment::PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters,
                                 const BlockPlan& plan)
    : parameters_(parameters),
      engine_(EngineFor(spec)),
      plan_(plan),
      random_{spec.seed, PointStream(spec.experiment, parameters)} {}

Model PointExperiment::model() const {
  return engine_ == Engine::kReference ? Model::kBilliardReference : Model::kBilliard;
}

std::unique_ptr<const PointExperiment> PointExperiment::Create(const EnsembleSpec& spec,
                                                               size_t index) {
  const PointParameters point = PointAt(spec, index);
  const PairGeometry geometry = PairGeometry::Create(point.rho, point.delta).value();
  switch (spec.experiment) {
    case Experiment::kEquilibrium:
      return std::make_unique<EquilibriumExperiment>(spec, point, geometry);
    case Experiment::kConditionalMeanFreeTime:
      return std::make_unique<ConditionalMeanFreeTimeExperiment>(spec, point, geometry);
    case Experiment::kFirstHit:
      return std::make_unique<FirstHitExperiment>(spec, point, geometry);
    case Experiment::kUnspecified:
      break;
  }
  return nullptr;
}

bool PointExperiment::TargetReached(uint64_t blocks, const BlockResult& merged) const {
  if (blocks >= plan_.Blocks()) return true;
  if (!plan_.tolerance || blocks < kMinBlocks) return false;
  const Estimate estimate = FirstEstimate(merged);
  return estimate.standard_error &&
         *estimate.standard_error <= *plan_.tolerance * std::fabs(estimate.value);
}

}  // namespace ballpiston
