// Pairs in equilibrium at total energy 1/2: the flow's invariant measure mu (uniform on Gamma times
// the unit sphere of velocities) and the return map's measure nu_bp (uniform on the collision
// surface, velocity density v.n over the outgoing hemisphere, n = (-1, 0, 1)/sqrt(2); eq. cnu).
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// From mu: anywhere in the flow's phase space.
PairState DrawFromFlowMeasure(const PairGeometry& geometry, CounterRandom& random);

// From mu at a piston energy in [0, 1/2]: positions and directions are uniform, and the energy
// fixes the speeds.
PairState DrawFromFlowMeasureAt(const PairGeometry& geometry, double epsilon,
                                CounterRandom& random);

// From nu_bp: just after a ball-piston collision.
PairState DrawFromCollisionMeasure(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston
