// How far the limit delta -> 0 is from the billiard at a delta: the model error of `markov` and of
// the spectrum, in their relaxation time.
//
// Known beforehand, from the mechanism and fitted to what was measured (docs/markov-limit.md): a
// piston that needs as long as a mean free time for its interval of lambda + 2 delta comes back by
// the clock, not by chance. So in equilibrium the error is of order x log(1/x), x = (lambda + 2
// delta)/tau_bp, which falls as delta^2 log(1/delta). From a given energy it is that of the energy
// itself: u tau_bp against lambda + 2 delta, and the ball's speed likewise.
//
// Established by a pilot: a billiard run of fixed size beside the spectrum. While it is small the
// error falls with delta at least in proportion (it is of order delta^2 log(1/delta), by its
// mechanism), so a pilot at a delta where collisions are cheap bounds all smaller ones. A pilot is
// a function of where it is made alone: results that rest on one are the same whoever made it, and
// when.
#ifndef BALLPISTON_CORE_MODEL_CHOICE_LIMIT_ERROR_H_
#define BALLPISTON_CORE_MODEL_CHOICE_LIMIT_ERROR_H_

#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/experiment/ensemble_spec.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// The order of the relaxation time's relative error: in equilibrium within a factor of two of what
// was measured, from a given energy within five, where effects of either sign meet.
double ExpectedLimitError(const PointParameters& point);

// A pilot's place. Several deltas may share one.
struct PilotPlace {
  double rho = 0;
  double delta = 0;
  std::optional<double> epsilon = {};

  friend auto operator<=>(const PilotPlace&, const PilotPlace&) = default;
};

PointParameters PointOf(const PilotPlace& place);

inline constexpr int64_t kPilotOrbits = 65536;

// Where the error at that point is looked at; its delta is the point's or larger.
PilotPlace PilotPlaceFor(const PointParameters& point);

// (billiard - limit)/limit of the relaxation time.
struct Pilot {
  double difference = 0;
  double standard_error = 0;
  bool predicted = false;  // not run: what is expected of it
};

// Some seconds of one core. Empty only if `stop` was requested.
std::optional<Pilot> RunPilot(const PilotPlace& place, std::stop_token stop);

// What that takes, predicted; in processor time.
double SecondsOfPilot(const PilotPlace& place, const MachineRates& rates);

// What a pilot is expected to say.
Pilot PredictedPilot(const PilotPlace& place);

// What the limit's relative error at the point is within, by a pilot at its place: the difference
// and two of its standard errors, scaled; not less than is expected anyway.
double LimitErrorBound(const Pilot& pilot, const PilotPlace& place, const PointParameters& point);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MODEL_CHOICE_LIMIT_ERROR_H_
