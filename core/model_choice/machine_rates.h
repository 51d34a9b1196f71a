// How fast this machine computes: what predictions of cost are made from.
#ifndef BALLPISTON_CORE_MODEL_CHOICE_MACHINE_RATES_H_
#define BALLPISTON_CORE_MODEL_CHOICE_MACHINE_RATES_H_

#include "core/billiard/orbits.h"

namespace ballpiston {

// Of an engine, in seconds of processor time.
struct EngineRate {
  double wall_hit = 0;   // in lanes the ball's alone; of the reference, any event
  double collision = 0;  // of ball and piston, in an orbit that goes on
  double sample = 0;     // an orbit's start and end
};

struct MachineRates {
  double first_point = 0;  // of a job, besides what it takes itself: nothing of it is in a cache
  double closed_form = 0;  // a point
  double spectrum = 0;     // a point
  double jump = 0;         // one of the jump process, with what is measured of it
  EngineRate lanes;
  EngineRate lanes_single;
  EngineRate reference;

  const EngineRate& Of(Engine engine) const;
};

// Measured on the calling thread in some 0.3 s.
MachineRates MeasureMachineRates();

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MODEL_CHOICE_MACHINE_RATES_H_
