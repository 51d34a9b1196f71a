#include "core/experiment/return_orbits.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/pair_state.h"
#include "core/sampling/collision_surface.h"

namespace ballpiston {

ReturnOrbits::ReturnOrbits(const PairGeometry& geometry, const ReturnLaw& law,
                           const RandomStream& random, const Block& block)
    : geometry_(geometry),
      law_(law.epsilon, law.exponent),
      ball_speed_(std::sqrt(1 - 2 * law.epsilon)),
      piston_speed_(std::sqrt(2 * law.epsilon)),
      random_(random),
      first_(block.first),
      returns_(block.samples) {}

PairState ReturnOrbits::Start(uint64_t orbit) {
  CounterRandom random = random_.Sample(first_ + orbit);
  const Eigen::Vector2d ball = UniformOnCollisionSurface(geometry_, random);
  const SignedDirection outgoing = law_.Draw(random);
  return {.position = ball,
          .direction = outgoing.ball,
          .ball_speed = ball_speed_,
          .piston = ball.x(),
          .piston_velocity = outgoing.sigma * piston_speed_};
}

AfterContact ReturnOrbits::Meet(uint64_t orbit, const Contact& contact) {
  returns_[orbit] = {.time = contact.time,
                     .direction = contact.state.direction,
                     .sigma = std::signbit(contact.state.piston_velocity) ? -1 : 1,
                     .energy_error = EnergyError(contact.state),
                     .escaped = contact.escaped};
  return AfterContact::kEnd;
}

bool Healthy(const Return& sample, Health& health) {
  if (sample.escaped) {
    ++health.escapes;
    return false;
  }
  health.max_energy_error = std::max(health.max_energy_error, sample.energy_error);
  return true;
}

}  // namespace ballpiston
