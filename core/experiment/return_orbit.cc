#include "core/experiment/return_orbit.h"

#include <cmath>
#include <numbers>

#include "core/billiard/reference_flow.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/pair_measures.h"
#include "core/experiment/flight_to_collision.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/collision_surface.h"

namespace ballpiston {

ReturnOrbit::ReturnOrbit(const PairGeometry& geometry, double epsilon, double exponent)
    : geometry_(geometry),
      law_(epsilon, exponent),
      ball_speed_(std::sqrt(1 - 2 * epsilon)),
      piston_speed_(std::sqrt(2 * epsilon)) {}

std::optional<Return> ReturnOrbit::Run(CounterRandom random, const std::stop_token& stop) const {
  const Eigen::Vector2d ball = UniformOnCollisionSurface(geometry_, random);
  const SignedDirection outgoing = law_.Draw(random);
  ReferenceFlow flow(geometry_, {.position = ball,
                                 .direction = outgoing.ball,
                                 .ball_speed = ball_speed_,
                                 .piston = ball.x(),
                                 .piston_velocity = outgoing.sigma * piston_speed_});
  const std::optional<Flight> flight = FlyToCollision(flow, stop);
  if (!flight) return std::nullopt;
  return Return{.time = flight->time,
                .direction = flow.state().direction,
                .sigma = std::signbit(flow.state().piston_velocity) ? -1 : 1,
                .health = {.escapes = flight->escaped ? uint64_t{1} : uint64_t{0},
                           .max_energy_error = EnergyError(flow.state())}};
}

double EventsPerReturn(const PairGeometry& geometry, double epsilon) {
  // Rate of hits on a wall of area |dG| at fixed speed: speed/pi |dG|/|G| for the ball, whose
  // direction is uniform in its plane, and speed/2 |dG|/|G| for the piston.
  const PairMeasures measures = Measures(geometry);
  const double ball = std::sqrt(1 - 2 * epsilon) * measures.area_ball_wall * std::numbers::inv_pi;
  const double piston = std::sqrt(2 * epsilon) * measures.area_piston_wall / 2;
  return 1 + ConditionalMeanFreeTime(geometry, epsilon) * (ball + piston) / measures.volume;
}

}  // namespace ballpiston
