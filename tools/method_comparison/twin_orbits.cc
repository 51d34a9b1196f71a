#include <algorithm>

#include "core/sampling/invariant_measure.h"
#include "tools/flows/rounded_to.h"
#include "tools/method_comparison/trajectory_horizon.h"

namespace ballpiston::method_comparison {
namespace {

TwinOrbits::State StartOnWall(const PairGeometry& geometry, CounterRandom random) {
  PairState drawn = DrawFromFlowMeasure(geometry, random);
  drawn.ball_speed = 1;
  drawn.piston = geometry.piston_right();
  drawn.piston_velocity = 0;
  TwinOrbits::State state = RoundedTo<TwinNumber>(drawn);
  state.direction /= TwinNumber(sqrt(TwinNumber(state.direction.squaredNorm())));
  EventFlow<TwinNumber> flow(geometry, state);
  flow.Step();
  return flow.state();
}

}  // namespace

TwinOrbits::TwinOrbits(const PairGeometry& geometry, const RandomStream& random, size_t count) {
  orbits_.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const State start = StartOnWall(geometry, random.Sample(i));
    orbits_.push_back({start, {geometry, start}, {{0, RoundedTo<double>(start).position}}});
  }
}

void TwinOrbits::Step(Orbit* orbit) {
  const double duration = static_cast<double>(orbit->flow.Step().duration);
  orbit->places.push_back(
      {orbit->places.back().time + duration, RoundedTo<double>(orbit->flow.state()).position});
}

void TwinOrbits::FlyAhead(size_t hits) {
  for (Orbit& orbit : orbits_) {
    while (orbit.places.size() <= hits) Step(&orbit);
  }
}

std::optional<Eigen::Vector2d> TwinOrbits::PositionAt(size_t orbit, double time) {
  std::vector<BallAt>& places = orbits_[orbit].places;
  while (places.back().time < time && places.size() <= kMostTwinHits) Step(&orbits_[orbit]);
  if (places.back().time < time) return std::nullopt;
  const auto end = std::lower_bound(places.begin(), places.end(), time,
                                    [](const BallAt& at, double t) { return at.time < t; });
  if (end == places.begin()) return end->position;
  const BallAt& from = *(end - 1);
  const double share = (time - from.time) / (end->time - from.time);
  return from.position + share * (end->position - from.position);
}

}  // namespace ballpiston::method_comparison
