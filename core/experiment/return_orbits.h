// Returns to the collision surface at fixed energies: start uniform on dGamma_bp with an outgoing
// law, fly until ball and piston meet next, and keep how they meet, before the collision is
// resolved. What first-hit and conditional-mean-free-time repeat: an OrbitSource, each orbit one
// sample.
#ifndef BALLPISTON_CORE_EXPERIMENT_RETURN_ORBITS_H_
#define BALLPISTON_CORE_EXPERIMENT_RETURN_ORBITS_H_

#include <cstdint>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/experiment/block_result.h"
#include "core/experiment/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "core/sampling/outgoing_law.h"

namespace ballpiston {

struct Return {
  double time = 0;
  Eigen::Vector2d direction = {0, 0};  // of the ball, ingoing: (cos alpha, sin alpha)
  int sigma = 0;                       // sign of the piston's velocity, ingoing
  double energy_error = 0;
  bool escaped = false;  // then nothing else means anything
};

struct ReturnLaw {
  double epsilon;
  double exponent;
};

class ReturnOrbits : public OrbitSource {
 public:
  // Samples first ... first + count - 1 of the stream.
  ReturnOrbits(const PairGeometry& geometry, const ReturnLaw& law, const RandomStream& random,
               uint64_t first, uint64_t count);

  PairState Start(uint64_t orbit) override;
  AfterContact Meet(uint64_t orbit, const Contact& contact) override;

  // By sample; complete after RunOrbits.
  const std::vector<Return>& returns() const { return returns_; }

 private:
  PairGeometry geometry_;
  OutgoingLaw law_;
  double ball_speed_;
  double piston_speed_;
  RandomStream random_;
  uint64_t first_;
  std::vector<Return> returns_;
};

// Adds the sample's health to the block's; true if it may be counted.
bool Healthy(const Return& sample, Health& health);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_RETURN_ORBITS_H_
