// A machine to predict for, the choice, and the ladder.
#pragma once

#include "core/ensemble/experiment_kind.h"
#include "core/model_choice/ladder.h"
#include "tests/core/asked.h"

namespace ballpiston {

// Round numbers near those of a processor of the day.
inline Machine SomeMachine() {
  Machine machine;
  machine.rates.closed_form = 1e-6;
  machine.rates.spectrum = 1e-4;
  machine.rates.jump = 5e-8;
  machine.rates.lanes = {.wall_hit = 2e-9, .collision = 2e-7, .sample = 4e-7};
  machine.rates.lanes_single = {.wall_hit = 1e-9, .collision = 2e-7, .sample = 4e-7};
  machine.rates.reference = {.wall_hit = 4e-8, .collision = 4e-8, .sample = 2e-7};
  machine.workers = 1;
  return machine;
}

inline EnsembleSpec Relaxation(double delta, const Target& target = {}) {
  return SpecOf(&kEnergyRelaxation, PaperPoint(delta), target);
}

inline Answer Choice(const EnsembleSpec& spec, const Machine& machine = SomeMachine()) {
  EXPECT_TRUE(Violations(spec).empty());
  return ChooseAnswer(spec, PointAt(spec, 0), machine);
}

inline Ladder Planned(const EnsembleSpec& spec, const Machine& machine = SomeMachine()) {
  return LadderFor(spec, PointAt(spec, 0), machine);
}

}  // namespace ballpiston
