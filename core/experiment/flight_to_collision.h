// The flight from one ball-piston collision to the next: its time and how many walls were hit.
#ifndef BALLPISTON_CORE_EXPERIMENT_FLIGHT_TO_COLLISION_H_
#define BALLPISTON_CORE_EXPERIMENT_FLIGHT_TO_COLLISION_H_

#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/billiard/reference_flow.h"

namespace ballpiston {

struct Flight {
  double time = 0;
  uint64_t ball_wall_hits = 0;
  uint64_t piston_wall_hits = 0;
  bool escaped = false;
};

// Leaves `flow` at the collision, unresolved. Empty only if `stop` was requested.
std::optional<Flight> FlyToCollision(ReferenceFlow& flow, const std::stop_token& stop);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_FLIGHT_TO_COLLISION_H_
