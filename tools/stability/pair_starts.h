// Starts of ball-piston pairs just before situations in which methods fail. wall_starts.h defines
// the offsets.
//
// Most starts are computed backwards: the state in the target situation is reversed and moved over
// a few wall hits. In this way an engine makes a few hits before it reaches the situation.
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

using DrawStart = PairState(const PairGeometry& geometry, CounterRandom& random);

// Any orbit, drawn from the invariant measure of the return map.
PairState AnyCollision(const PairGeometry& geometry, CounterRandom& random);

// The ball hits the wall at the end of the piston, in the wedge between the two: it hits wall and
// piston at the same instant, up to the offset.
PairState AimedAtPistonsEdge(const PairGeometry& geometry, CounterRandom& random);

// The ball hits the piston at the instant at which the piston turns at its left wall.
PairState AimedAtPistonsTurn(const PairGeometry& geometry, CounterRandom& random);

// Ball and piston reach the right tip at the same instant.
PairState AimedAtTipAndPiston(const PairGeometry& geometry, CounterRandom& random);

// The ball hits the piston anywhere. For small delta, where random orbits rarely hit it.
PairState AimedAtPiston(const PairGeometry& geometry, CounterRandom& random);

// Just after a collision, within an offset of wall and piston in their wedge.
PairState InTheWedge(const PairGeometry& geometry, CounterRandom& random);

// Just after a collision. The energy of the ball (or piston) is an offset, or exactly 0.
PairState SlowBall(const PairGeometry& geometry, CounterRandom& random);
PairState SlowPiston(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston::stability
