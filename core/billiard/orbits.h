// Orbits of many ball-piston pairs, from collision to collision: what every experiment runs.
//
// Two engines do the same work behind one interface.
//   kReference  one orbit after the other by ReferenceFlow, every event resolved.
//   kLanes      the ball's flight between walls in vector lanes, without positions; the piston is
//               not stepped: it is a triangle wave in time, and whether a flight met it is seen
//               from where both are at its end and whether the piston turned meanwhile.
//               ReferenceFlow resolves the flights that did, and the first one after a collision.
//
// An orbit's numbers do not depend on the lane it ran in, on how many lanes there are, or on what
// runs beside it: every operation is elementwise, and exact, correctly rounded or fused as written.
// So the bits are the same on every processor with fused multiply-add. The two engines round
// differently: their orbits agree for some 30 wall hits, then only in law.
#ifndef BALLPISTON_CORE_BILLIARD_ORBITS_H_
#define BALLPISTON_CORE_BILLIARD_ORBITS_H_

#include <cstdint>
#include <limits>
#include <stop_token>

#include "core/billiard/reference_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

enum class Engine { kReference, kLanes, kLanesSingle };

// How an orbit came to a ball-piston collision.
struct Contact {
  PairState state;  // in contact, still approaching: as ExchangeComponents of the flow wants it
  double time = 0;  // since the orbit's start, or its collision before
  uint64_t ball_wall_hits = 0;
  uint64_t piston_wall_hits = 0;
  bool escaped = false;  // the orbit left the cell: nothing else here means anything
  bool expired = false;  // not within the orbit's time limit: `state` means nothing, and `time`
                         // only that it passed

  void Add(const Event& event);  // one more on the way
};

enum class AfterContact { kGoOn, kEnd };

// Where orbits come from, and what becomes of their collisions. Called from the thread that runs
// the orbits, for different orbits in an order that depends on the engine: keep what is measured by
// orbit, and combine it by the orbits' numbers.
class OrbitSource {
 public:
  virtual ~OrbitSource() = default;
  // The pair at the start of that orbit.
  virtual PairState Start(uint64_t orbit) = 0;
  // A collision of that orbit. kGoOn: ball and piston exchange components and the orbit goes on.
  // After an escape, and when its time limit passed, it ends whatever is returned.
  virtual AfterContact Meet(uint64_t orbit, const Contact& contact) = 0;
  // Time without a collision after which an orbit is of no more use: its source is told, some time
  // after that or at a later collision, and the orbit ends. What keeps slow pistons, slow balls,
  // and those at rest for ever, from being waited for.
  virtual double TimeLimit() const { return std::numeric_limits<double>::infinity(); }
};

// Runs orbits 0 ... orbits - 1 to their ends. False if `stop` came before that.
bool RunOrbits(Engine engine, const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
               const std::stop_token& stop);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_ORBITS_H_
