// The speed of a machine, from which costs are predicted. The core has no clock: the caller of a
// prediction measures the rates and passes them in.
#pragma once

#include "core/billiard/orbits.h"

namespace ballpiston {

// The speed of an engine, in seconds of processor time.
struct EngineRate {
  double wall_hit = 0;   // a wall hit: in lanes, of the ball only; in the reference, any event
  double collision = 0;  // of ball and piston, in an orbit that continues
  double sample = 0;     // an orbit's start and end
  double lanes = 1;      // orbits that the engine moves at the same time
};

struct MachineRates {
  double closed_form = 0;  // a point by a closed form
  double spectrum = 0;     // a point by the spectrum
  double jump = 0;         // a jump of the jump process, with its measurements
  EngineRate lanes;
  EngineRate lanes_single;
  EngineRate reference;

  const EngineRate& Of(Engine engine) const {
    if (engine == Engine::kReference) return reference;
    return engine == Engine::kLanesSingle ? lanes_single : lanes;
  }
};

}  // namespace ballpiston
