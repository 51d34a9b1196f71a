// Starts of balls alone, of ball-piston pairs and of gases: anywhere, or just before situations in
// which methods fail.
//
// The offset from the target is +-10^-k, k = 3 ... 17, or exactly 0: one of 16 values at random.
#pragma once

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

double RandomOffset(CounterRandom& random);

using DrawStart = PairState(const PairGeometry& geometry, CounterRandom& random);

// ---- a ball alone ----
//
// On a wall, with a velocity away from it. The piston rests at its right wall, out of the ball's
// reach.

// A wall point, uniform in the angle at the disc's centre; the direction follows the cosine law.
PairState AnywhereOnWall(const PairGeometry& geometry, CounterRandom& random);

// From a wall in sight of a tip towards that tip; the direction has an offset.
PairState AimedAtTip(const PairGeometry& geometry, CounterRandom& random);

// Past a disc in sight with impact parameter rho (1 - offset).
PairState AimedToGraze(const PairGeometry& geometry, CounterRandom& random);

// ---- ball and piston ----
//
// Most starts are computed backwards: the state in the target situation is reversed and moved over
// a few wall hits. In this way an engine makes a few hits before it reaches the situation.

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

// ---- a gas ----
//
// The fastest body has about speed 1.

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
