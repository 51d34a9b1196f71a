// Gases about to come where methods fail. The fastest body has about speed 1. Offsets as in
// wall_starts.h.
#ifndef BALLPISTON_TOOLS_STABILITY_GAS_STARTS_H_
#define BALLPISTON_TOOLS_STABILITY_GAS_STARTS_H_

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/sampling/counter_random.h"
#include "tools/stability/drawn_starts.h"

namespace ballpiston::stability {

using DrawGasStart = GasState(const GasGeometry& geometry, CounterRandom& random);

// From the canonical ensemble.
GasState AnyGas(const GasGeometry& geometry, CounterRandom& random);

// One ball moves; the energies of all other bodies are offsets, or exactly 0.
GasState OneHotBall(const GasGeometry& geometry, CounterRandom& random);
// The same for one piston.
GasState OneHotPiston(const GasGeometry& geometry, CounterRandom& random);

// Energies from 1 down to 1e-17, with an even law of their logarithms.
GasState AnyEnergies(const GasGeometry& geometry, CounterRandom& random);

// A ball comes to a wall where two pistons that cross have their ends: at delta's bound, all four
// meet at one point. For lattices.
GasState AimedAtTwoPistons(const GasGeometry& geometry, CounterRandom& random);

// The pair that `draw` draws, in the place of a ball and one of its pistons. All else is at rest:
// balls in the middle of their cells, pistons on their edges, where no ball comes.
GasState WithPair(DrawStart& draw, const GasGeometry& geometry, CounterRandom& random);

template <DrawStart* draw>
GasState WithPair(const GasGeometry& geometry, CounterRandom& random) {
  return WithPair(*draw, geometry, random);
}

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GAS_STARTS_H_
