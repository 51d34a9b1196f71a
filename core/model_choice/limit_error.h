// The error of the limit delta -> 0 at a given delta, relative to the billiard: the model error of
// `markov` and of the spectrum, in their relaxation time.
//
// experiment/expected_limit_error.h gives an upper bound in advance, and its coverage.
//
// A pilot checks this bound: a billiard run of fixed size, compared with the spectrum. A small
// error falls with delta at least in proportion (its mechanism gives the order delta^2
// log(1/delta)). So a pilot at a delta where collisions are cheap serves all smaller deltas. A
// pilot can raise the bound but never lower it, so the coverage stays. A pilot's result depends on
// its place alone, so an answer does not depend on which job ran the pilot, or when. A pilot has
// its own random numbers, which do not depend on the job's seed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// A pilot's place: a point of energy-relaxation. Several points may share one.
using PilotPlace = PointParameters;

inline constexpr int64_t kPilotOrbits = 65536;

// The place of the pilot for a point. The place's delta is that of the point or larger.
PilotPlace PilotPlaceFor(const PointParameters& point);

// (billiard - limit)/limit of the relaxation time.
struct Pilot {
  double difference = 0;
  double standard_error = 0;
  bool predicted = false;  // the pilot has not run; the values are predictions
};

// The billiard run of a pilot, a few seconds of one core, and its result when it is merged.
std::unique_ptr<const PointExperiment> PilotExperiment(const PilotPlace& place);
Pilot PilotOf(const PointExperiment& experiment, const BlockResult& merged);

// Predicted processor time of a pilot.
double SecondsOfPilot(const PilotPlace& place, const MachineRates& rates);

// The expected result of a pilot.
Pilot PredictedPilot(const PilotPlace& place);

// Upper bound of the limit's relative error at the point, by a pilot at its place: the pilot's
// difference plus two of its standard errors, in proportion to delta; at least ExpectedLimitError.
double LimitErrorBound(const Pilot& pilot, const PilotPlace& place, const PointParameters& point);

// In words: by which pilot a bound was found.
std::string FoundBy(const Pilot& pilot, const PilotPlace& place);

}  // namespace ballpiston
