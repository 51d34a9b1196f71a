// The checks of collisions find planted failures: a watch receives the collisions of a correct
// engine with omissions or changes. The naive methods show that the checks of single hits find
// failures: the program complains about a check that finds none for any method.
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/energy.h"
#include "tools/stability/pair_watch.h"

namespace ballpiston::stability {
namespace {

constexpr double kEpsilon = 2.2e-16;

PairGeometry Geometry() { return *PairGeometry::Create(0.6, PairDeltaBound(0.6)); }

std::vector<PairState> Starts() {
  std::vector<PairState> starts;
  for (uint64_t i = 0; i < 500; ++i) {
    CounterRandom random(31, 0, i);
    starts.push_back(DrawFromCollisionMeasure(Geometry(), random));
  }
  return starts;
}

// Changes collisions and passes them to a watch.
class Tampered : public NumberedOrbits {
 public:
  using Change = void (*)(Collision& collision);

  Tampered(CollisionWatch& watch, Change change) : watch_(watch), change_(change) {}

  PairState Start(uint64_t orbit) override { return watch_.Start(orbit); }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    Collision changed = collision;
    change_(changed);
    return watch_.Collide(orbit, changed);
  }

 private:
  CollisionWatch& watch_;
  Change change_;
};

Failures Watched(Tampered::Change change) {
  const std::vector<PairState> starts = Starts();
  CollisionWatch watch(Geometry(), kEpsilon, starts, 4);
  Tampered source(watch, change);
  RunOrbits(Engine::kReference, Geometry(), starts.size(), source);
  return watch.Finish();
}

struct Planted {
  const char* what;
  Tampered::Change change;
  uint64_t Failures::*counted;
  uint64_t least;
};

TEST(Detectors, PlantedFailuresAreCounted) {
  for (const Planted& planted :
       {Planted{"a late collision is a phantom", [](Collision& c) { c.time += 1e-6; },
                &Failures::phantoms, 100},
        {"an early collision is a phantom", [](Collision& c) { c.time -= 1e-6; },
         &Failures::phantoms, 100},
        {"a turned velocity", [](Collision& c) { c.state.direction = -c.state.direction; },
         &Failures::inward, 100},
        {"a negative time", [](Collision& c) { c.time = -c.time; }, &Failures::negative_times, 100},
        {"an escape that is reported", [](Collision& c) { c.escaped = true; }, &Failures::escapes,
         500},
        {"an escape that is not", [](Collision& c) { c.state.position.y() += 0.3; },
         &Failures::escapes, 500}}) {
    EXPECT_GE(Watched(planted.change).*planted.counted, planted.least) << planted.what;
  }
  EXPECT_GT(Watched([](Collision& c) { c.state.ball_speed *= 1 + 1e-9; }).energy, 1e-10);
  const Failures unchanged = Watched([](Collision&) {});
  EXPECT_EQ(unchanged.hits, 2000u);
  EXPECT_GT(unchanged.looked_back, 300u);
  EXPECT_EQ(unchanged.Total(), 0u);
}

// One step from the start to the second collision: the ball passes through the piston in between.
class EverySecond : public NumberedOrbits {
 public:
  EverySecond(CollisionWatch& watch, size_t orbits) : watch_(watch), first_(orbits) {}

  PairState Start(uint64_t orbit) override { return watch_.Start(orbit); }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    Collision& first = first_[orbit];
    if (first.time == 0) {
      first = collision;
      return AfterCollision::kGoOn;
    }
    Collision both = collision;
    both.time += first.time;
    both.ball_wall_hits += first.ball_wall_hits;
    return watch_.Collide(orbit, both);
  }

 private:
  CollisionWatch& watch_;
  std::vector<Collision> first_;
};

TEST(Detectors, AnOmittedCollisionIsMissed) {
  const std::vector<PairState> starts = Starts();
  CollisionWatch watch(Geometry(), kEpsilon, starts, 1);
  EverySecond source(watch, starts.size());
  RunOrbits(Engine::kReference, Geometry(), starts.size(), source);
  EXPECT_GT(watch.Finish().missed, 10u);
  EXPECT_EQ(CollisionWatch(Geometry(), kEpsilon, starts, 1).Finish().missed, 500u);  // all orbits
}

TEST(Detectors, ANanEnergyErrorIsInfiniteAndAMissingErrorIsNan) {
  Failures looked;
  looked.Merge(Failures());
  EXPECT_TRUE(std::isnan(looked.energy));
  looked.SeeEnergy(1e-3);
  looked.SeeEnergy(std::nan(""));
  looked.SeeEnergy(1e-3);
  looked.Merge(Failures());
  EXPECT_EQ(looked.energy, HUGE_VAL);
  Failures all = {.energy = 1e-3};
  all.Merge(looked);
  EXPECT_EQ(all.energy, HUGE_VAL);
}

TEST(Detectors, AnEnergyThatIsNotANumberDrifts) {
  EnergyRecord record;
  for (const double share : {0.1, 0.5, 0.9}) record.Add(share, 0);
  EXPECT_FALSE(record.Drift().IsTrend());
  EXPECT_EQ(record.Worst(), 0);
  record.Add(0.7, std::nan(""));
  record.Add(0.8, 0);
  EXPECT_TRUE(record.Drift().IsTrend());
  EXPECT_EQ(record.Worst(), HUGE_VAL);
}

// On a wall of the lower left disc, halfway between its tips.
TEST(Detectors, HitsOfAWallAreChecked) {
  const PairGeometry geometry = Geometry();
  const Eigen::Vector2d normal = Eigen::Vector2d(1, 1).normalized();
  const Eigen::Vector2d wall = Eigen::Vector2d(-0.5, -0.5) + geometry.rho() * normal;
  struct Hit {
    const char* what;
    Eigen::Vector2d position, direction;
    double time;
    uint64_t Failures::*counted = nullptr;
  };
  for (const Hit& hit :
       {Hit{"a leaving ball", wall, normal, 0.1},
        {"an inward ball", wall, -normal, 0.1, &Failures::inward},
        {"a ball inside a disc", wall - 1e-13 * normal, normal, 0.1, &Failures::escapes},
        {"a ball nowhere", {NAN, 0}, normal, 0.1, &Failures::escapes},
        {"a time of minus an ulp", wall, normal, -1e-17, &Failures::negative_times}}) {
    Failures failures;
    const bool goes_on =
        BallWatch(geometry, kEpsilon).Hit(hit.position, hit.direction, hit.time, failures);
    EXPECT_EQ(goes_on, hit.counted != &Failures::escapes) << hit.what;
    EXPECT_EQ(failures.Total(), hit.counted == nullptr ? 0u : 1u) << hit.what;
    EXPECT_TRUE(hit.counted == nullptr || failures.*hit.counted == 1) << hit.what;
  }
  // At rho = 0.6 the tips permit two successive hits, and rounding a few more.
  BallWatch watch(geometry, kEpsilon);
  Failures failures;
  int hits = 0;
  while (watch.Hit(wall, normal, 0, failures)) ASSERT_LT(++hits, 20);
  EXPECT_EQ(failures.loops, 1u);
  EXPECT_GT(hits, 2);
}

}  // namespace
}  // namespace ballpiston::stability
