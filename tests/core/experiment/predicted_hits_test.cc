#include "core/experiment/predicted_hits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/billiard/orbits.h"
#include "core/experiment/return_orbits.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/moments.h"

namespace ballpiston {
namespace {

constexpr double kPaperRho = 0.529561127988977;

struct Counted {
  Moments ball_wall, piston_wall;
  void Add(const Contact& contact) {
    ball_wall.Add(static_cast<double>(contact.ball_wall_hits));
    piston_wall.Add(static_cast<double>(contact.piston_wall_hits));
  }
};

// To the first collision.
class InEquilibrium : public OrbitSource {
 public:
  explicit InEquilibrium(const PairGeometry& geometry) : geometry_(geometry) {}
  PairState Start(uint64_t orbit) override {
    CounterRandom random(3, 4, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }
  AfterContact Meet(uint64_t, const Contact& contact) override {
    counted.Add(contact);
    return AfterContact::kEnd;
  }
  Counted counted;

 private:
  PairGeometry geometry_;
};

class CountedReturns : public ReturnOrbits {
 public:
  using ReturnOrbits::ReturnOrbits;
  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
    counted.Add(contact);
    return ReturnOrbits::Meet(orbit, contact);
  }
  Counted counted;
};

// Exact means, as the paper's measures are: 5 standard errors, 6e-7 false alarms each. Starts in
// contact: what is counted between two collisions is what comes before the second.
void ExpectCounted(const PredictedHits& predicted, const Counted& counted) {
  EXPECT_NEAR(counted.ball_wall.mean, predicted.ball_wall, 5 * *counted.ball_wall.StandardError());
  EXPECT_NEAR(counted.piston_wall.mean, predicted.piston_wall,
              5 * *counted.piston_wall.StandardError());
  EXPECT_EQ(predicted.Events(), 1 + predicted.ball_wall + predicted.piston_wall);
}

TEST(PredictedHits, AreThoseOfOrbitsInEquilibrium) {
  for (const double rho : {0.501, kPaperRho, 0.65}) {
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.6 * PairDeltaBound(rho));
    InEquilibrium source(geometry);
    ASSERT_TRUE(RunOrbits(Engine::kReference, geometry, 20'000, source, {}));
    ExpectCounted(HitsPerCollision(geometry), source.counted);
  }
}

// From the law that is its own: exponent 1.
TEST(PredictedHits, AreThoseOfReturnsAtAnEnergy) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.25);
  for (const double epsilon : {0.05, 0.2, 0.35, 0.45}) {
    CountedReturns returns(geometry, {epsilon, 1}, {.seed = 1, .stream = 2}, 0, 20'000);
    ASSERT_TRUE(RunOrbits(Engine::kReference, geometry, 20'000, returns, {}));
    ExpectCounted(HitsPerReturn(geometry, epsilon), returns.counted);
  }
}

}  // namespace
}  // namespace ballpiston
