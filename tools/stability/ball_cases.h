// The situations without a piston in which methods fail, and the failures of each method there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"
#include "tools/stability/ball_methods.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

struct BallCase {
  struct Radius {
    double rho;
    uint64_t starts;  // in the full table
  };

  std::string name;
  std::vector<Radius> radii;
  PairState (*start)(const PairGeometry& geometry, CounterRandom& random);
  uint64_t hits;  // per start; 0: until no tip can hold the ball any longer
};

const std::vector<BallCase>& BallCases();

// Runs the case's number of starts, times `effort` and the method's share. All methods have the
// same starts.
Failures FlyCase(const BallCase& ball_case, const BallMethod& method, double effort);

}  // namespace ballpiston::stability
