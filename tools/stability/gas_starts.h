// Starts of gases just before situations in which methods fail. The fastest body has about speed 1.
// pair_starts.h defines the offsets.
#pragma once

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/sampling/counter_random.h"
#include "tools/stability/pair_starts.h"

namespace ballpiston::stability {

using DrawGasStart = GasState(const GasGeometry& geometry, CounterRandom& random);

// A gas from the canonical ensemble.
GasState AnyGas(const GasGeometry& geometry, CounterRandom& random);

// One ball moves; the energies of all other bodies are offsets, or exactly 0.
GasState OneHotBall(const GasGeometry& geometry, CounterRandom& random);
// The same for one piston.
GasState OneHotPiston(const GasGeometry& geometry, CounterRandom& random);

// Energies from 1 to 1e-17, uniform in the logarithm.
GasState AnyEnergies(const GasGeometry& geometry, CounterRandom& random);

// A ball hits a wall at the point where the ends of two crossing pistons are: at the bound of
// delta, all four meet at this point. For lattices.
GasState AimedAtTwoPistons(const GasGeometry& geometry, CounterRandom& random);

// A ball and one of its pistons start as the pair that `draw` draws. All other bodies are at rest:
// balls at the centres of their cells, pistons on their edges, out of the reach of the balls.
GasState WithPair(DrawStart& draw, const GasGeometry& geometry, CounterRandom& random);

template <DrawStart* draw>
GasState WithPair(const GasGeometry& geometry, CounterRandom& random) {
  return WithPair(*draw, geometry, random);
}

}  // namespace ballpiston::stability
