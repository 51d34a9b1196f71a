// The checks of collisions find planted failures: a watch receives the collisions of a correct
// engine with omissions or changes. The naive methods show that the checks of single hits find
// failures: the program complains about a check that finds none for any method.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/sampling/invariant_measure.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/energy_drift.h"
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

TEST(Detectors, UnchangedCollisionsGiveNoFailure) {
  const Failures failures = Watched([](Collision&) {});
  EXPECT_EQ(failures.hits, 2000u);
  EXPECT_GT(failures.looked_back, 300u);
  EXPECT_EQ(failures.Total(), 0u);
}

TEST(Detectors, ALateCollisionIsAPhantom) {
  const Failures failures = Watched([](Collision& c) { c.time += 1e-6; });
  EXPECT_GT(failures.phantoms, 100u);
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
}

TEST(Detectors, AnOmittedOrbitIsMissed) {
  const std::vector<PairState> starts = Starts();
  CollisionWatch watch(Geometry(), kEpsilon, starts, 1);
  EXPECT_EQ(watch.Finish().missed, 500u);
}

TEST(Detectors, TurnedVelocitiesEscapesAndTimesAreDetected) {
  EXPECT_GT(Watched([](Collision& c) { c.state.direction = -c.state.direction; }).inward, 100u);
  EXPECT_GT(Watched([](Collision& c) { c.time = -c.time; }).negative_times, 100u);
  EXPECT_EQ(Watched([](Collision& c) { c.escaped = true; }).escapes, 500u);
  EXPECT_EQ(Watched([](Collision& c) { c.state.position.y() += 0.3; }).escapes, 500u);
  EXPECT_GT(Watched([](Collision& c) { c.state.ball_speed *= 1 + 1e-9; }).energy, 1e-10);
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
  EnergyRun run = {
      .method = "", .what = "", .hits = 0, .orbits = 1, .promised = true, .record = {}};
  for (const double share : {0.1, 0.5, 0.9}) run.record.Add(share, 0);
  EXPECT_FALSE(Drifts(run));
  EXPECT_EQ(run.record.Worst(), 0);
  run.record.Add(0.7, std::nan(""));
  run.record.Add(0.8, 0);
  EXPECT_TRUE(Drifts(run));
  EXPECT_EQ(run.record.Worst(), HUGE_VAL);
}

// On a wall of the lower left disc, halfway between its tips.
class OnTheWall : public ::testing::Test {
 protected:
  PairGeometry geometry_ = Geometry();
  Eigen::Vector2d normal_ = Eigen::Vector2d(1, 1).normalized();
  Eigen::Vector2d position_ = Eigen::Vector2d(-0.5, -0.5) + geometry_.rho() * normal_;
  BallWatch watch_ = BallWatch(geometry_, kEpsilon);
  Failures failures_;
};

TEST_F(OnTheWall, ALeavingBallGivesNoFailure) {
  EXPECT_TRUE(watch_.Hit(position_, normal_, 0.1, failures_));
  EXPECT_EQ(failures_.Total(), 0u);
}

TEST_F(OnTheWall, AnInwardBallIsDetected) {
  watch_.Hit(position_, -normal_, 0.1, failures_);
  EXPECT_EQ(failures_.inward, 1u);
}

TEST_F(OnTheWall, ABallInsideADiscHasEscaped) {
  EXPECT_FALSE(watch_.Hit(position_ - 1e-13 * normal_, normal_, 0.1, failures_));
  EXPECT_FALSE(watch_.Hit({NAN, 0}, normal_, 0.1, failures_));
  EXPECT_EQ(failures_.escapes, 2u);
}

TEST_F(OnTheWall, TimesOfMinusAnUlpAreNegative) {
  watch_.Hit(position_, normal_, -1e-17, failures_);
  EXPECT_EQ(failures_.negative_times, 1u);
}

// At rho = 0.6 the tips permit two successive hits, and rounding a few more.
TEST_F(OnTheWall, ABallThatStaysIsALoop) {
  int hits = 0;
  while (watch_.Hit(position_, normal_, 0, failures_)) ASSERT_LT(++hits, 20);
  EXPECT_EQ(failures_.loops, 1u);
  EXPECT_GT(hits, 2);
}

}  // namespace
}  // namespace ballpiston::stability
