// One return to the collision surface at fixed energies: start uniform on dGamma_bp with an
// outgoing law, fly until ball and piston meet next, and report how they meet, before the
// collision is resolved. What first-hit and conditional-mean-free-time repeat.
#ifndef BALLPISTON_CORE_EXPERIMENT_RETURN_ORBIT_H_
#define BALLPISTON_CORE_EXPERIMENT_RETURN_ORBIT_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/experiment/block_result.h"
#include "core/geometry/pair_geometry.h"
#include "core/sampling/counter_random.h"
#include "core/sampling/outgoing_law.h"

namespace ballpiston {

struct Return {
  double time = 0;
  Eigen::Vector2d direction;  // of the ball, ingoing: (cos alpha, sin alpha)
  int sigma = 0;              // sign of the piston's velocity, ingoing
  Health health;              // after an escape the other members mean nothing
};

class ReturnOrbit {
 public:
  ReturnOrbit(const PairGeometry& geometry, double epsilon, double exponent);

  // Empty only if `stop` was requested.
  std::optional<Return> Run(CounterRandom random, const std::stop_token& stop) const;

 private:
  PairGeometry geometry_;
  OutgoingLaw law_;
  double ball_speed_;
  double piston_speed_;
};

// Predicted events of one return: mean return time times the rates of wall hits at these energies.
double EventsPerReturn(const PairGeometry& geometry, double epsilon);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_RETURN_ORBIT_H_
