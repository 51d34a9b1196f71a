#include "core/billiard/orbits.h"

#include "core/billiard/lane_orbits.h"
#include "core/billiard/reference_flow.h"

namespace ballpiston {
namespace {

constexpr uint64_t kEventsBetweenLooks =
    4096;  // some 0.2 ms: `stop` costs nothing, answers at once

bool RunReferenceOrbit(const PairGeometry& geometry, uint64_t orbit, OrbitSource& source,
                       const std::stop_token& stop) {
  ReferenceFlow flow(geometry, source.Start(orbit));
  const double limit = source.TimeLimit();
  Contact contact;
  for (uint64_t events = 1;; ++events) {
    const Event event = flow.Step();
    contact.Add(event);
    contact.expired = contact.time > limit;
    if (event.kind == EventKind::kBallPiston || contact.escaped || contact.expired) {
      contact.state = flow.state();
      const bool has_ended = contact.escaped || contact.expired;
      if (source.Meet(orbit, contact) == AfterContact::kEnd || has_ended) return true;
      flow.ExchangeComponents();
      contact = {};
    }
    if (events % kEventsBetweenLooks == 0 && stop.stop_requested()) return false;
  }
}

}  // namespace

void Contact::Add(const Event& event) {
  time += event.duration;
  ball_wall_hits += event.kind == EventKind::kBallWall;
  piston_wall_hits += event.kind == EventKind::kPistonWall;
  escaped = event.kind == EventKind::kEscape;
}

bool RunOrbits(Engine engine, const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
               const std::stop_token& stop) {
  if (engine == Engine::kLanes) return RunLaneOrbits(geometry, orbits, source, stop);
  if (engine == Engine::kLanesSingle) return RunLaneOrbitsSingle(geometry, orbits, source, stop);
  for (uint64_t orbit = 0; orbit < orbits; ++orbit) {
    if (!RunReferenceOrbit(geometry, orbit, source, stop)) return false;
  }
  return true;
}

}  // namespace ballpiston
