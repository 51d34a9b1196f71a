// Looks at ball-piston pairs: after each event where a method tells it, else at each collision.
#ifndef BALLPISTON_TOOLS_STABILITY_PAIR_WATCH_H_
#define BALLPISTON_TOOLS_STABILITY_PAIR_WATCH_H_

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/billiard/orbits.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// Events in a row that take no time. A corner of walls and piston is worked off in a few hits; a
// tip into which the piston presses the ball takes a tip's sequence between any two of them.
uint64_t LongestStandstill(const PairGeometry& geometry);

// How deep inside a disc a ball may be off the walls. There nothing tells by which cosine rounding
// was magnified: the worst case, a ball that grazes, counts.
double AnywhereSlack(double epsilon);

// One orbit, every event of it.
class PairWatch {
 public:
  PairWatch(const PairGeometry& geometry, double epsilon);

  // The state after the event, before an exchange. False when the orbit came to a bad end.
  bool See(const PairState& state, EventKind kind, double duration, Failures& failures);
  // After an exchange.
  void SeeExchanged(const PairState& state, Failures& failures);

 private:
  BallWatch ball_;
  double epsilon_;
  double short_;
  uint64_t longest_standstill_;
  uint64_t standstill_ = 0;
};

// Many orbits of an engine that tells collisions only. Whether one was missed is seen by flying the
// ball from the collision before, through the piston: neither may it be beyond the piston before
// the engine's collision, nor elsewhere then. Rounding grows with every hit, so this is asked of
// flights with few hits, and of them and of two neighbours to either side: what is out on all
// three, by more than they differ, is no rounding.
class CollisionWatch : public NumberedOrbits {
 public:
  CollisionWatch(const PairGeometry& geometry, double epsilon, std::span<const PairState> starts,
                 uint64_t collisions);

  PairState Start(uint64_t orbit) override;
  AfterContact Meet(uint64_t orbit, const Contact& contact) override;

  // Orbits that have not come to their end count as having missed the piston.
  Failures Finish();

 private:
  struct Orbit {
    PairState departure;
    uint64_t collisions = 0;
    uint64_t standstill = 0;
    bool ended = false;
  };

  void LookBack(const PairState& departure, const Contact& contact);
  Failures AsGhostsTell(const PairState& departure, const Contact& contact, int neighbours) const;
  AfterContact End(Orbit& orbit);

  PairGeometry geometry_;
  BallWatch ball_;
  double epsilon_;
  std::span<const PairState> starts_;
  uint64_t collisions_;
  uint64_t longest_standstill_;
  std::vector<Orbit> orbits_;
  Failures failures_;
};

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_PAIR_WATCH_H_
