#include "tools/stability/reversal.h"

#include <algorithm>
#include <limits>

#include "core/geometry/paper.h"
#include "core/sampling/invariant_measure.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/ball_methods.h"
#include "tools/stability/wall_starts.h"

namespace ballpiston::stability {
namespace {

constexpr double kReversalDelta = 0.1;
constexpr uint64_t kReversalSeed = 22;
constexpr size_t kEnough = 50;  // the smallest number of orbits for a median

double Median(std::vector<double> values) {
  if (values.size() < kEnough) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The first collision of each orbit.
class FirstCollisions : public NumberedOrbits {
 public:
  explicit FirstCollisions(std::vector<PairState> starts)
      : starts_(std::move(starts)), collisions_(starts_.size()) {}

  PairState Start(uint64_t orbit) override { return starts_[orbit]; }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    collisions_[orbit] = collision;
    return AfterCollision::kEnd;
  }

  const std::vector<Collision>& Run(Engine engine, const PairGeometry& geometry) {
    RunOrbits(engine, geometry, starts_.size(), *this);
    return collisions_;
  }

 private:
  std::vector<PairState> starts_;
  std::vector<Collision> collisions_;
};

Reversal ReversalOf(Engine engine, const std::string& name, uint64_t orbits) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, kReversalDelta);
  std::vector<PairState> starts, turned;
  for (uint64_t i = 0; i < orbits; ++i) {
    CounterRandom random(kReversalSeed, 1, i);
    starts.push_back(DrawFromCollisionMeasure(geometry, random));
  }
  FirstCollisions there(starts);
  const std::vector<Collision>& collisions = there.Run(engine, geometry);
  for (const Collision& collision : collisions) {
    turned.push_back(collision.state);
    turned.back().direction = -collision.state.direction;
    turned.back().piston_velocity = -collision.state.piston_velocity;
  }
  FirstCollisions back(turned);
  const std::vector<Collision>& returns = back.Run(engine, geometry);
  Reversal reversal = {.method = name, .median = {}};
  for (size_t k = 0; k < kReversalHits.size(); ++k) {
    std::vector<double> distances;
    for (size_t i = 0; i < orbits; ++i) {
      if (collisions[i].ball_wall_hits != kReversalHits[k]) continue;
      distances.push_back((returns[i].state.position - starts[i].position).norm());
    }
    reversal.median[k] = Median(distances);
  }
  return reversal;
}

}  // namespace

std::vector<Reversal> BallReversals(uint64_t orbits) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, kReversalDelta);
  std::vector<PairState> starts;
  for (uint64_t i = 0; i < orbits; ++i) {
    CounterRandom random(kReversalSeed, 0, i);
    starts.push_back(AnywhereOnWall(geometry, random));
  }
  std::vector<Reversal> reversals;
  for (const BallMethod& method : BallMethods()) {
    Reversal reversal = {.method = method.name, .median = {}};
    for (size_t k = 0; k < kReversalHits.size(); ++k) {
      reversal.median[k] = Median(method.there_and_back(geometry, starts, kReversalHits[k]));
    }
    reversals.push_back(reversal);
  }
  return reversals;
}

std::vector<Reversal> PairReversals(uint64_t orbits) {
  return {ReversalOf(Engine::kLanes, "lanes", orbits),
          ReversalOf(Engine::kLanesSingle, "lanes, single", orbits),
          ReversalOf(Engine::kReference, "reference", orbits)};
}

}  // namespace ballpiston::stability
