// Ball-piston pairs about to come where methods fail. Offsets as in wall_starts.h.
//
// Most starts are made backwards: from the instant that is aimed at, the reversed velocities are
// flown over a few wall hits, so that an engine is in full flight when it comes there.
#ifndef BALLPISTON_TOOLS_STABILITY_PAIR_STARTS_H_
#define BALLPISTON_TOOLS_STABILITY_PAIR_STARTS_H_

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

// Any orbit: from the return map's invariant measure.
PairState AnyCollision(const PairGeometry& geometry, CounterRandom& random);

// The ball comes to the wall where the piston's end does, in the wedge between the two: wall and
// piston at the same instant, give or take the offset.
PairState AimedAtPistonsEdge(const PairGeometry& geometry, CounterRandom& random);

// The ball comes to the piston in the instant in which it turns at its left wall.
PairState AimedAtPistonsTurn(const PairGeometry& geometry, CounterRandom& random);

// The ball comes to the right tip when the piston does.
PairState AimedAtTipAndPiston(const PairGeometry& geometry, CounterRandom& random);

// The ball comes to the piston anywhere: for small delta, where chance would not do it.
PairState AimedAtPiston(const PairGeometry& geometry, CounterRandom& random);

// Just after a collision, within an offset of wall and piston in their wedge.
PairState InTheWedge(const PairGeometry& geometry, CounterRandom& random);

// Just after a collision, the ball's or the piston's energy an offset, or exactly 0.
PairState SlowBall(const PairGeometry& geometry, CounterRandom& random);
PairState SlowPiston(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_PAIR_STARTS_H_
