// The work of a sample, for chunk plans and for predictions of its cost on a machine.
#ifndef BALLPISTON_CORE_ENSEMBLE_SAMPLE_WORK_H_
#define BALLPISTON_CORE_ENSEMBLE_SAMPLE_WORK_H_

namespace ballpiston {

// Mean numbers of events.
struct SampleWork {
  double ball_wall = 0;
  double piston_wall = 0;
  double collisions = 0;  // of ball and piston, in orbits that continue
  double starts = 0;      // of orbits, with their ends, in units of the simplest start
  double jumps = 0;       // of the limit's jump process, or measurements of a step of the energy

  // The sum, in units of a wall hit in lanes.
  double Events() const {
    constexpr double kEventsPerJump = 25;
    return ball_wall + piston_wall + collisions + starts + kEventsPerJump * jumps;
  }

  SampleWork Times(double n) const {
    return {n * ball_wall, n * piston_wall, n * collisions, n * starts, n * jumps};
  }
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ENSEMBLE_SAMPLE_WORK_H_
