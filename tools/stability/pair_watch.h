// Checks ball-piston pairs: after each event if the method reports all events, else at each
// collision.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// Checks every event of one orbit.
class PairWatch {
 public:
  PairWatch(const PairGeometry& geometry, double epsilon);

  // Checks the state after the event, before an exchange. False if the orbit has failed.
  bool See(const PairState& state, EventKind kind, double duration, Failures& failures);
  // Checks the state after an exchange.
  void SeeExchanged(const PairState& state, Failures& failures);

 private:
  BallWatch ball_;
  double epsilon_;
  double short_;
  Standstill standstill_;
};

// Checks many orbits of an engine that reports only collisions. To find a missed collision, the
// ball is moved from the previous collision through the piston. It must not be beyond the piston
// before the engine's collision, and it must be at the piston at the engine's collision. Rounding
// errors grow with every hit. Therefore only flights with few hits are checked, together with two
// neighbouring flights, one on each side. A deviation of all three flights that is larger than
// their differences is not a rounding error.
class CollisionWatch : public NumberedOrbits {
 public:
  CollisionWatch(const PairGeometry& geometry, double epsilon, std::span<const PairState> starts,
                 uint64_t collisions);

  PairState Start(uint64_t orbit) override { return orbits_[orbit].departure; }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override;

  // An orbit that has not reached its end counts as a missed piston.
  Failures Finish();

 private:
  struct Orbit {
    PairState departure;
    Standstill standstill;
    uint64_t collisions = 0;
    double middle_error = 0;  // dE/E in the middle of the run
    bool ended = false;
  };

  void LookBack(const PairState& departure, const Collision& collision);
  Failures AsGhostsTell(const PairState& departure, const Collision& collision,
                        int neighbours) const;
  AfterCollision End(Orbit& orbit);

  PairGeometry geometry_;
  BallWatch ball_;
  double epsilon_;
  uint64_t collisions_;
  std::vector<Orbit> orbits_;
  Failures failures_;
};

}  // namespace ballpiston::stability
