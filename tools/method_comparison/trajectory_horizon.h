// The number of wall hits for which the orbits of a method stay close to their twins.
//
// After each hit of the method's ball, the ball's position is compared with the twin's position at
// the same time. (A fixed step detects a hit up to one step late; therefore hits of the same number
// cannot be compared.) A method starts from its own rounding of the twin's start. The error eps of
// one hit grows by a factor exp(L) per hit, where L is the Lyapunov exponent. Therefore the horizon
// is about log(kParted/eps)/L. Property, with a test of its name:
// 1. HorizonGrowsWithTheLogarithmOfThePrecision.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ensemble/random_stream.h"
#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tools/flows/precise_flow.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

inline constexpr size_t kMostTwinHits = 256;

// A point of an orbit.
struct BallAt {
  double time = 0;  // cells at unit speed, since the start
  Eigen::Vector2d position = {0, 0};
};

// Orbits of the ball alone in 256 bits: the twins of orbits with fewer bits.
//
// An error grows by about a factor of e per wall hit. Therefore a twin is correct for about 170
// hits, more than twice as long as an orbit in 113 bits.
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

// The positions of every orbit after each of its hits; a lost orbit has fewer.
struct Itineraries {
  std::vector<std::vector<BallAt>> orbits;
  double seconds = 0;
};

// The largest number of hits of an orbit. All orbits of 113 bits part earlier, while the twin is
// still correct. If the cell is hardly larger than kParted (rho near 1/sqrt(2)), some orbits do not
// part; then this number counts as their horizon.
inline constexpr uint64_t kMostHits = 128;

struct TrajectoryHorizon {
  Moments hits = {};       // per orbit, until the orbit and its twin are kParted apart
  uint64_t wall_hits = 0;  // computed in `seconds`, also those after the parting
  double seconds = 0;      // of processor time, without the time of the twins
};

// The horizon of all orbits of `twins`. Requires a method with orbits.
TrajectoryHorizon HorizonOf(const Method& method, const PairGeometry& geometry, TwinOrbits& twins);

}  // namespace ballpiston::method_comparison
