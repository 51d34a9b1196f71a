// Orbits of many ball-piston pairs, from collision to collision. All experiments with a pair use
// them.
//
// Two engines do the same work behind one interface.
//   kReference  computes one orbit after the other by ReferenceFlow, event by event.
//   kLanes      computes the ball's flights between walls in vector lanes, without positions. The
//               piston's position is a triangle wave in time, which the engine evaluates only when
//               the ball is within the piston's reach. The engine finds a collision from the
//               positions of both bodies at the flight's end and at the piston's turning point, and
//               resolves the collision within the flight. The orbit then continues in its lane.
//
// An orbit's numbers do not depend on its lane, on the number of lanes, or on other orbits: every
// operation is elementwise, and is exact, correctly rounded or fused as written. So the bits are
// the same on every processor with fused multiply-add. The two engines round differently: their
// orbits agree for about 30 wall hits, then only in law.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "core/billiard/event_flow.h"
#include "core/billiard/tangent_map.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

// A run of an engine: the orbits of pairs, or the blocks of a point (ensemble/block_run.h), from a
// source that supplies the work.
class EngineRun {
 public:
  virtual ~EngineRun() = default;
  // Returns true when no work is in progress and the source has no more now. Returns false when the
  // source's Pause is true. May be called again in both cases, from any thread.
  virtual bool Advance() = 0;
};

enum class Engine { kReference, kLanes, kLanesSingle };

// A ball-piston collision of an orbit, and the orbit's path to it.
struct Collision {
  PairState state;  // in contact, before the exchange of velocity components
  double time = 0;  // since the orbit's start or its previous collision
  uint64_t ball_wall_hits = 0;
  uint64_t piston_wall_hits = 0;
  // Rounding has lost the orbit: it left the cell, or waited longer than any orbit does
  // (longest_wait.h). All other fields are meaningless.
  bool escaped = false;
  // No collision within the time limit: `time` means only that the limit has passed, and all other
  // fields are meaningless.
  bool expired = false;
  // The tangent map of the ball's flights since the orbit's start or its previous collision. Only
  // in the lanes, if the source follows tangents; otherwise, and for a ball at rest, the identity.
  BallMap flights = {};

  void Add(const Event& event);  // adds an event before the collision
};

enum class AfterCollision { kGoOn, kEnd };

// A pair at the start of an orbit. The source chooses the orbit's number.
struct OrbitStart {
  uint64_t orbit = 0;
  PairState state = {};
};

class OrbitDevice;

// Supplies the starts of orbits and receives their collisions. The thread that runs the orbits
// calls the source. The order of calls for different orbits depends on the engine, so a source must
// keep its measurements by orbit and combine them in the order of the orbits' numbers.
class OrbitSource {
 public:
  virtual ~OrbitSource() = default;
  // The next orbit. Empty if the source has no more orbits now; the lanes ask again about 0.2 ms
  // later, as long as they have other orbits in progress.
  virtual std::optional<OrbitStart> Next() = 0;
  // kGoOn: ball and piston exchange components, and the orbit continues. An orbit that escaped or
  // expired ends for any answer.
  virtual AfterCollision Collide(uint64_t orbit, const Collision& collision) = 0;
  // An orbit expires after this time without a collision: the source receives an expired collision,
  // and the orbit ends. The expired collision may come later than the limit. Without a limit an
  // orbit waits for LongestWait (longest_wait.h), and is then reported as escaped. So every orbit
  // ends.
  virtual double TimeLimit() const { return std::numeric_limits<double>::infinity(); }
  // Whether the source follows tangent vectors. If so, the reference calls FollowEvent after each
  // event, at a collision before Collide. The lanes report the map of the ball's flights with each
  // collision.
  virtual bool FollowsTangents() const { return false; }
  virtual void FollowEvent(uint64_t /*orbit*/, const Event&, const PairState& /*after*/) {}
  // The device that computes the flights of kLanes instead of the processor; null: none. Orbits
  // with tangents never use it. It must outlive the run.
  virtual OrbitDevice* Device() const { return nullptr; }
  // True if the engine should return. The processor's engines ask about 5000 times a second, and at
  // least every 0.05 s if a call of Next or Collide takes at most 10 us. A run on a device asks
  // once in each launch.
  virtual bool Pause() = 0;
};

// Computes orbits to the bits of kLanes (gpu/device_orbits.h). Thread-safe.
class OrbitDevice {
 public:
  virtual ~OrbitDevice() = default;
  // About how many orbits all runs together have in progress at the same time.
  virtual uint64_t orbits() const = 0;
  // Null if the device cannot be used; then the processor computes.
  virtual std::unique_ptr<EngineRun> Start(const PairGeometry& geometry, OrbitSource& source) = 0;
};

// Orbits in progress. An engine keeps as many lanes full as the source can fill. The source must
// outlive the run.
std::unique_ptr<EngineRun> StartOrbits(Engine engine, const PairGeometry& geometry,
                                       OrbitSource& source);

// kLanes on the processor, without the source's device.
std::unique_ptr<EngineRun> StartLaneOrbits(const PairGeometry& geometry, OrbitSource& source);
// kLanesSingle: flights in single precision, which are faster, with the errors that
// billiard_domain.h states.
std::unique_ptr<EngineRun> StartLaneOrbitsSingle(const PairGeometry& geometry, OrbitSource& source);

}  // namespace ballpiston
