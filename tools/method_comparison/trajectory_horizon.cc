#include "tools/method_comparison/trajectory_horizon.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/sampling/invariant_measure.h"
#include "tools/flows/rounded_to.h"

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

// The number of hits before the parting; empty if orbit and twin are still together after `hits`.
std::optional<uint64_t> HitsTogether(const std::vector<BallAt>& places, uint64_t hits, size_t orbit,
                                     TwinOrbits& twins) {
  for (size_t k = 0; k < places.size(); ++k) {
    if (!std::isfinite(places[k].time)) return k;
    const std::optional<Eigen::Vector2d> twin = twins.PositionAt(orbit, places[k].time);
    if (!twin || !((places[k].position - *twin).norm() <= kParted)) return k;
  }
  if (places.size() < hits) return places.size();  // lost
  return std::nullopt;
}

// Empty if an orbit stays within kParted of its twin to the end. At the largest number of hits this
// number counts as the horizon of such an orbit.
std::optional<TrajectoryHorizon> HorizonWithin(uint64_t hits, const Itineraries& itineraries,
                                               TwinOrbits& twins) {
  TrajectoryHorizon horizon = {.seconds = itineraries.seconds};
  for (size_t i = 0; i < itineraries.orbits.size(); ++i) {
    const std::optional<uint64_t> together = HitsTogether(itineraries.orbits[i], hits, i, twins);
    if (!together && hits < kMostHits) return std::nullopt;
    horizon.hits.Add(static_cast<double>(together.value_or(hits)));
    horizon.wall_hits += itineraries.orbits[i].size();
  }
  return horizon;
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

TrajectoryHorizon HorizonOf(const Method& method, const PairGeometry& geometry, TwinOrbits& twins) {
  for (uint64_t hits = 16;; hits *= 2) {
    const auto horizon =
        HorizonWithin(hits, method.fly(geometry, twins, hits, method.time_step), twins);
    if (horizon) return *horizon;
  }
}

}  // namespace ballpiston::method_comparison
