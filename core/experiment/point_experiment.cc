#include "core/experiment/point_experiment.h"

#include <cmath>
#include <utility>

#include "core/experiment/closed_form_summary.h"
#include "core/experiment/computed_answer.h"
#include "core/experiment/conditional_mean_free_time.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/engine_choice.h"
#include "core/experiment/equilibrium.h"
#include "core/experiment/first_hit.h"
#include "core/experiment/markov_property.h"
#include "core/experiment/point_stream.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

namespace {

// The jump process and the billiard are to be compared: with numbers of their own.
uint64_t StreamOf(const EnsembleSpec& spec, const PointParameters& parameters) {
  const uint64_t stream = PointStream(spec.experiment, parameters);
  return spec.model == Model::kMarkov ? ~stream : stream;
}

std::unique_ptr<PointExperiment> RelaxationBy(const EnsembleSpec& spec,
                                              const PointParameters& point,
                                              const PairGeometry& geometry) {
  if (spec.model == Model::kSpectrum) {
    return std::make_unique<ComputedAnswer>(spec, point,
                                            EnergyRelaxationBySpectrum(geometry, point));
  }
  return std::make_unique<EnergyRelaxationExperiment>(spec, point, geometry);
}

std::unique_ptr<PointExperiment> ByClosedForm(const EnsembleSpec& spec,
                                              const PointParameters& point,
                                              const PairGeometry& geometry) {
  return std::make_unique<ComputedAnswer>(spec, point,
                                          ClosedFormSummary(spec.experiment, geometry, point));
}

std::unique_ptr<PointExperiment> ByModel(const EnsembleSpec& spec, const PointParameters& point) {
  const PairGeometry geometry = PairGeometry::Create(point.rho, point.delta).value();
  if (spec.model == Model::kClosedForm) return ByClosedForm(spec, point, geometry);
  switch (spec.experiment) {
    case Experiment::kEquilibrium:
      return std::make_unique<EquilibriumExperiment>(spec, point, geometry);
    case Experiment::kConditionalMeanFreeTime:
      return std::make_unique<ConditionalMeanFreeTimeExperiment>(spec, point, geometry);
    case Experiment::kFirstHit:
      return std::make_unique<FirstHitExperiment>(spec, point, geometry);
    case Experiment::kEnergyRelaxation:
      return RelaxationBy(spec, point, geometry);
    case Experiment::kMarkovProperty:
      return std::make_unique<MarkovPropertyExperiment>(spec, point, geometry);
    case Experiment::kUnspecified:
      break;
  }
  return nullptr;
}

}  // namespace

PointExperiment::PointExperiment(const EnsembleSpec& spec, const PointParameters& parameters,
                                 const BlockPlan& plan)
    : parameters_(parameters),
      answer_{.model = spec.model == Model::kAuto ? Model::kBilliard : spec.model},
      engine_(EngineFor(spec)),
      plan_(plan),
      random_{spec.seed, StreamOf(spec, parameters)} {}

std::unique_ptr<const PointExperiment> PointExperiment::Create(const EnsembleSpec& spec,
                                                               size_t index) {
  const PointParameters point = PointAt(spec, index);
  return ByModel(OnePointSpec(spec, point, spec.model), point);
}

std::unique_ptr<const PointExperiment> PointExperiment::Create(const EnsembleSpec& spec,
                                                               size_t index, Answer answer) {
  const PointParameters point = PointAt(spec, index);
  std::unique_ptr<PointExperiment> experiment =
      ByModel(OnePointSpec(spec, point, answer.model), point);
  if (experiment != nullptr) experiment->answer_ = std::move(answer);
  return experiment;
}

bool MeetsTolerance(const Estimate& estimate, double tolerance) {
  return estimate.standard_error &&
         *estimate.standard_error <= tolerance * std::fabs(estimate.value);
}

bool PointExperiment::TargetReached(uint64_t blocks, const BlockResult& merged) const {
  if (blocks >= plan_.Blocks()) return true;
  if (!plan_.tolerance || blocks < kMinBlocks) return false;
  return MeetsTolerance(FirstEstimate(merged), *plan_.tolerance);
}

}  // namespace ballpiston
