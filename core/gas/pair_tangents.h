// All six tangent vectors of the pair, followed through every event of the reference as those of a
// gas of one ball and one piston. They are the yardstick of billiard/tangent_plane.h.
//
// The vectors start as an orthonormal basis of
//   two velocities across w, the flow (w, 0), the energy (0, w), two positions across w,
// in this order; w: the velocities of ball and piston as one vector. In a long orbit their growth
// is the exponents times the time, in descending order. The third, the fourth and the sum of all
// six are 0 in exact arithmetic for any orbit, because the flow and the energy are the third and
// the fourth vector: they show errors of the maps and of rounding.
//
// Properties, each with a test of its name: 1. EveryEngineHasTheExponentsOfAnotherProgram.
// 2. ExponentsComeInPairs.
#pragma once

#include <cstddef>
#include <vector>

#include "core/billiard/exchange.h"
#include "core/billiard/orbits.h"
#include "core/gas/gas_tangents.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

class PairTangents {
 public:
  static constexpr size_t kExponents = 6;

  // Requires a pair with the energy 1/2.
  PairTangents(const PairGeometry& geometry, const PairState& start)
      : tangents_(geometry.rho(), {{BallOf(start)}, {{start.piston, start.piston_velocity}}},
                  Basis(start)) {}

  // Every event, with the state after it; then, at a collision, the exchange.
  void Follow(const Event& event, const PairState& after) {
    time_ += event.duration;
    if (event.kind != EventKind::kBallPiston) Resolve(event.kind, after);
  }
  void Collide(const Collision& collision) {
    Resolve(EventKind::kBallPiston, AfterExchange(collision.state, 1.0));
  }

  // The logarithms of the factors by which the vectors have grown since the last call.
  std::vector<double> TakeGrowth() { return tangents_.TakeGrowth(time_); }

 private:
  static GasBall BallOf(const PairState& state) {
    return {state.position, state.direction, state.ball_speed};
  }

  static std::vector<GasTangents::Vector> Basis(const PairState& start) {
    const double ux = start.direction.x(), uy = start.direction.y();
    const double v = start.ball_speed, p = start.piston_velocity;
    return {{0, 0, -uy, ux, 0, 0},        {0, 0, p * ux, p * uy, 0, -v},
            {v * ux, v * uy, 0, 0, p, 0}, {0, 0, v * ux, v * uy, 0, p},
            {-uy, ux, 0, 0, 0, 0},        {p * ux, p * uy, 0, 0, -v, 0}};
  }

  void Resolve(EventKind kind, const PairState& after) {
    tangents_.Follow({.kind = kind, .time = time_, .ball = 0, .piston = 0}, BallOf(after));
  }

  GasTangents tangents_;
  double time_ = 0;  // since the start
};

}  // namespace ballpiston
