// Returns to the collision surface at fixed energies. An orbit starts uniformly on dGamma_bp with
// an outgoing law and ends at the next ball-piston collision. The ingoing velocities are recorded
// before the exchange. Each orbit is one sample of first-hit and of conditional-mean-free-time.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_result.h"
#include "core/ensemble/chunk_plan.h"
#include "core/ensemble/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "core/sampling/outgoing_law.h"

namespace ballpiston {

struct Return {
  double time = 0;
  Eigen::Vector2d direction = {0, 0};  // of the ball, ingoing: (cos alpha, sin alpha)
  int sigma = 0;                       // sign of the piston's velocity, ingoing
  double energy_error = 0;
  bool escaped = false;  // if true, all other fields are meaningless
};

// Returns may take any time; an engine gives up an orbit that cannot end (billiard/longest_wait.h).
inline constexpr double kNoTimeLimit = std::numeric_limits<double>::infinity();

struct ReturnLaw {
  double epsilon;
  double exponent;
};

// The returns of one block.
class ReturnOrbits {
 public:
  ReturnOrbits(const PairGeometry& geometry, const ReturnLaw& law, const RandomStream& random,
               const Block& block);

  uint64_t count() const { return returns_.size(); }
  PairState Start(uint64_t orbit);
  AfterContact Meet(uint64_t orbit, const Contact& contact);

  // In the order of samples; complete when all orbits have ended.
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
