#include "core/model_choice/limit_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_limit_error.h"
#include "core/geometry/pair_geometry.h"
#include "core/model_choice/sampling_cost.h"

namespace ballpiston {
namespace {

// Fraction of delta's bound. At this delta a collision takes about 250 wall hits, and a pilot 2 s.
constexpr double kPilotsShareOfTheBound = 0.3;
// A relative error above this does not fall with delta: it belongs to an energy at which the slower
// of ball and piston takes as long as the window. Near the energies without a relaxation time the
// relative error at a pilot's place is up to 2.5, but it falls with delta.
constexpr double kWhereItScales = 4;

EnsembleSpec PilotSpec(const PilotPlace& place) {
  return OnePointSpec({.experiment = &kEnergyRelaxation,
                       .target = {.samples = kPilotOrbits},
                       .purpose = Purpose::kPilot},
                      place, Model::kBilliard);
}

}  // namespace

PilotPlace PilotPlaceFor(const PointParameters& point) {
  PilotPlace cheap = point;
  cheap.Set(kDelta, std::max(point[kDelta], kPilotsShareOfTheBound * PairDeltaBound(point[kRho])));
  return ExpectedLimitError(cheap) < kWhereItScales ? cheap : point;
}

std::unique_ptr<const PointExperiment> PilotExperiment(const PilotPlace& place) {
  return PointExperiment::Create(PilotSpec(place), 0);
}

Pilot PilotOf(const PointExperiment& experiment, const BlockResult& merged) {
  const Estimate time = experiment.FirstEstimate(merged);
  if (!time.standard_error) return {.standard_error = std::numeric_limits<double>::infinity()};
  return {.difference = time.value / *time.limit - 1,
          .standard_error = *time.standard_error / std::fabs(*time.limit)};
}

double SecondsOfPilot(const PilotPlace& place, const MachineRates& rates) {
  const SamplingCost cost = CostOfSampling(PilotSpec(place), place, rates);
  return cost.Of(static_cast<double>(kPilotOrbits), 1);
}

Pilot PredictedPilot(const PilotPlace& place) {
  const Scatter scatter = ScatterOf(PilotSpec(place), place);
  return {.difference = ExpectedLimitError(place),
          .standard_error = scatter.error / std::sqrt(static_cast<double>(kPilotOrbits)),
          .predicted = true};
}

double LimitErrorBound(const Pilot& pilot, const PilotPlace& place, const PointParameters& point) {
  const double there = std::fabs(pilot.difference) + 2 * pilot.standard_error;
  return std::max(there * point[kDelta] / place[kDelta], ExpectedLimitError(point));
}

std::string FoundBy(const Pilot& pilot, const PilotPlace& place) {
  return absl::StrCat(
      pilot.predicted ? "expected of a pilot at delta = " : "two sigma of a pilot at delta = ",
      absl::StrFormat("%.2g", place[kDelta]));
}

}  // namespace ballpiston
