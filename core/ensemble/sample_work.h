// The work of a sample, for chunk plans and for predictions of its cost on a machine.
#pragma once

namespace ballpiston {

// Mean numbers of events.
struct SampleWork {
  double ball_wall = 0;
  double piston_wall = 0;
  double collisions = 0;  // of ball and piston, in orbits that continue
  double starts = 0;      // of orbits, with their ends, in units of the simplest start
  double jumps = 0;       // of the limit's jump process, or measurements of a step of the energy

  // The rest tells how costs differ from the sum of the events. Chunk plans do not depend on it.
  double delays = 0;  // further time in lanes, in wall hits; below 0: these hits are missing
  // The number of independent parts of a sample, for instance its collisions, whose durations add
  // up. Below 1: only this share of the samples takes long.
  double parts = 1;
  // Replicas of a gas that a thread runs from start to end together; 0 for orbits, of which each
  // lane takes the next one when its orbit has ended.
  double together = 0;

  // The sum, in units of a wall hit in lanes.
  double Events() const {
    constexpr double kEventsPerJump = 25;
    return ball_wall + piston_wall + collisions + starts + kEventsPerJump * jumps;
  }

  SampleWork Times(double n) const {
    return {n * ball_wall, n * piston_wall, n * collisions, n * starts,
            n * jumps,     n * delays,      n * parts,      together};
  }
};

}  // namespace ballpiston
