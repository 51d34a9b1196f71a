#include "core/experiment/flight_to_collision.h"

namespace ballpiston {
namespace {

constexpr uint64_t kHitsBetweenLooks = 4096;  // some 0.2 ms: `stop` costs nothing, answers at once

}  // namespace

std::optional<Flight> FlyToCollision(ReferenceFlow& flow, const std::stop_token& stop) {
  Flight flight;
  for (;;) {
    const Event event = flow.Step();
    flight.time += event.duration;
    if (event.kind == EventKind::kBallPiston) return flight;
    if (event.kind == EventKind::kEscape) {
      flight.escaped = true;
      return flight;
    }
    ++(event.kind == EventKind::kBallWall ? flight.ball_wall_hits : flight.piston_wall_hits);
    const uint64_t hits = flight.ball_wall_hits + flight.piston_wall_hits;
    if (hits % kHitsBetweenLooks == 0 && stop.stop_requested()) return std::nullopt;
  }
}

}  // namespace ballpiston
