#include "tools/method_comparison/trajectory_horizon.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/sampling/invariant_measure.h"
#include "server/processor_time.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/rounded_to.h"
#include "tools/method_comparison/method_orbits.h"

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

// The positions of every orbit after each of its hits; a lost orbit has fewer.
struct Itineraries {
  std::vector<std::vector<BallAt>> orbits;
  double seconds = 0;
};

template <typename To>
std::vector<PairStateOf<To>> Starts(const TwinOrbits& twins) {
  std::vector<PairStateOf<To>> starts;
  for (size_t i = 0; i < twins.Count(); ++i) starts.push_back(RoundedTo<To>(twins.Start(i)));
  return starts;
}

template <typename Flow>
void FlyOrbit(FlowOrbit<Flow> orbit, uint64_t hits, std::vector<BallAt>& places) {
  for (Collision way; places.size() < hits;) {
    orbit.Advance(way);
    if (way.escaped) return;
    if (way.ball_wall_hits == places.size()) continue;
    places.push_back({way.time, orbit.state().position});
  }
}

// Flies the orbits one after the other.
template <typename Flow, typename... TimeStep>
Itineraries FlyEach(const PairGeometry& geometry, const TwinOrbits& twins, uint64_t hits,
                    TimeStep... time_step) {
  const auto starts = Starts<RealOf<Flow>>(twins);
  Itineraries result;
  result.orbits.resize(starts.size());
  for (std::vector<BallAt>& places : result.orbits) places.reserve(hits);
  result.seconds = server::SecondsOf([&] {
    for (size_t i = 0; i < starts.size(); ++i) {
      result.orbits[i].clear();
      FlyOrbit(FlowOrbit<Flow>(geometry, starts[i], time_step...), hits, result.orbits[i]);
    }
  });
  return result;
}

// The measured time does not include the records of the positions: the lanes are so fast that the
// records would dominate.
Itineraries FlyInLanes(FlyLanes& fly, const PairGeometry& geometry, const TwinOrbits& twins,
                       uint64_t hits) {
  const std::vector<LaneFrame> frames = OnTheirWalls(Starts<double>(twins));
  std::vector<LaneHit> recorded(frames.size() * hits);
  fly(geometry, frames, hits, recorded);
  Itineraries result;
  for (size_t i = 0; i < frames.size(); ++i) {
    std::vector<BallAt>& places = result.orbits.emplace_back();
    double time = 0;
    for (size_t k = 0; k < hits; ++k) {
      const LaneHit& hit = recorded[i * hits + k];
      places.push_back({time += hit.length, PositionInCell(hit.frame)});
    }
  }
  result.seconds = server::SecondsOf([&] { fly(geometry, frames, hits, {}); });
  return result;
}

Itineraries Fly(const MethodVariant& variant, const PairGeometry& geometry, const TwinOrbits& twins,
                uint64_t hits) {
  if (variant.method == Method::kLanes) return FlyInLanes(FlyLaneBalls, geometry, twins, hits);
  if (variant.method == Method::kLanesSingle) {
    return FlyInLanes(FlyLaneBallsSingle, geometry, twins, hits);
  }
  return WithFlowOf(variant, [&]<typename Flow>(std::type_identity<Flow>, auto... time_step) {
    return FlyEach<Flow>(geometry, twins, hits, time_step...);
  });
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

// The horizons; empty if an orbit is with its twin to the end. At the largest number of hits this
// number counts as the horizon of such an orbit.
std::optional<Moments> Horizons(const Itineraries& itineraries, uint64_t hits, TwinOrbits& twins) {
  Moments moments;
  for (size_t i = 0; i < itineraries.orbits.size(); ++i) {
    const std::optional<uint64_t> together = HitsTogether(itineraries.orbits[i], hits, i, twins);
    if (!together && hits < kMostHits) return std::nullopt;
    moments.Add(static_cast<double>(together.value_or(hits)));
  }
  return moments;
}

uint64_t HitsIn(const Itineraries& itineraries) {
  uint64_t hits = 0;
  for (const std::vector<BallAt>& places : itineraries.orbits) hits += places.size();
  return hits;
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

TrajectoryHorizon HorizonOf(const MethodVariant& variant, const PairGeometry& geometry,
                            TwinOrbits& twins) {
  for (uint64_t hits = 16;; hits *= 2) {
    const Itineraries itineraries = Fly(variant, geometry, twins, hits);
    const std::optional<Moments> horizons = Horizons(itineraries, hits, twins);
    if (horizons) return {*horizons, HitsIn(itineraries), itineraries.seconds};
  }
}

}  // namespace ballpiston::method_comparison
