// Orbits of the ball alone in 256 bits: the twins of orbits with fewer bits.
//
// An error grows by about a factor of e per wall hit. Therefore a twin is correct for about 170
// hits, more than twice as long as an orbit in 113 bits.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/ensemble/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/precise_flow.h"

namespace ballpiston::method_comparison {

inline constexpr size_t kMostTwinHits = 256;

// A point of an orbit.
struct BallAt {
  double time = 0;  // cells at unit speed, since the start
  Eigen::Vector2d position = {0, 0};
};

class TwinOrbits {
 public:
  using State = PairStateOf<TwinNumber>;

  // Starts from the samples 0 ... count - 1 of the stream: in equilibrium, at unit speed, on the
  // wall that the ball hits first. The piston rests at its right wall, out of the ball's reach.
  TwinOrbits(const PairGeometry& geometry, const RandomStream& random, size_t count);

  size_t Count() const { return orbits_.size(); }
  const State& Start(size_t orbit) const { return orbits_[orbit].start; }

  // Computes the first `hits` hits of every orbit.
  void FlyAhead(size_t hits);

  // The twin's position at this time, time >= 0. Computes further hits as needed, at most up to the
  // hit kMostTwinHits; empty if more are needed.
  std::optional<Eigen::Vector2d> PositionAt(size_t orbit, double time);

 private:
  struct Orbit {
    State start;
    EventFlow<TwinNumber> flow;
    std::vector<BallAt> places;  // at the start and after each hit
  };

  static void Step(Orbit* orbit);

  std::vector<Orbit> orbits_;
};

}  // namespace ballpiston::method_comparison
