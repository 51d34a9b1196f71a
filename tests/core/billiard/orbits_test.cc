#include "core/billiard/orbits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/statistics/moments.h"
#include "tests/core/billiard/recorded_contacts.h"

namespace ballpiston {
namespace {

constexpr double kPaperRho = 0.529561127988977;

TEST(Orbits, EveryOrbitComesToItsEnd) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  for (const Engine engine : {Engine::kReference, Engine::kLanes, Engine::kLanesSingle}) {
    for (const uint64_t orbits : {1, 2, 7, 8, 9, 15, 16, 17, 31, 32, 33, 63, 64, 65, 1000}) {
      const RecordedContacts recorded = Recorded(engine, geometry, orbits, 3);
      for (const auto& contacts : recorded.by_orbit()) ASSERT_EQ(contacts.size(), 3u);
    }
  }
}

TEST(Orbits, ContactsAreOnTheCollisionSurfaceAndApproaching) {
  for (const double share : {1.0, 0.3, 0.03}) {
    const PairGeometry geometry =
        *PairGeometry::Create(kPaperRho, share * PairDeltaBound(kPaperRho));
    const RecordedContacts recorded = Recorded(Engine::kLanes, geometry, 500, 4);
    for (const auto& contacts : recorded.by_orbit()) {
      for (const Contact& contact : contacts) {
        const PairState& state = contact.state;
        ASSERT_FALSE(contact.escaped);
        ASSERT_LE(EnergyError(state), 1e-14);
        ASSERT_TRUE(InsideCell(geometry, state.position, 1e-12));
        ASSERT_NEAR(state.position.x(), state.piston, 1e-12);
        ASSERT_GT(state.ball_speed * state.direction.x(), state.piston_velocity);
      }
    }
  }
}

// Times and counts of the two engines: 5 combined standard errors of 20,000 flights each, 6e-7
// false alarms a comparison at most: starts are the same, so the two differ by less than
// independent ones.
TEST(Orbits, LanesAndReferenceAgreeInLaw) {
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho));
    Moments time[2], ball[2], piston[2], speed[2];
    const Engine engines[] = {Engine::kReference, Engine::kLanes};
    for (size_t i = 0; i < 2; ++i) {
      const RecordedContacts recorded = Recorded(engines[i], geometry, 5000, 4);
      for (const auto& contacts : recorded.by_orbit()) {
        for (const Contact& contact : contacts) {
          time[i].Add(contact.time);
          ball[i].Add(static_cast<double>(contact.ball_wall_hits));
          piston[i].Add(static_cast<double>(contact.piston_wall_hits));
          speed[i].Add(contact.state.ball_speed);
        }
      }
    }
    for (const Moments* m : {time, ball, piston, speed}) {
      const double error = std::hypot(*m[0].StandardError(), *m[1].StandardError());
      EXPECT_NEAR(m[0].mean, m[1].mean, 5 * error) << "rho " << rho;
    }
  }
}

TEST(Orbits, StopEndsThem) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 1e-7);
  std::stop_source stop;
  stop.request_stop();
  for (const Engine engine : {Engine::kReference, Engine::kLanes}) {
    RecordedContacts recorded(geometry, 10, 1);
    EXPECT_FALSE(RunOrbits(engine, geometry, 10, recorded, stop.get_token()));
  }
}

// A ball that rests where the piston does not come: only the piston has events, for ever.
class RestingBall : public OrbitSource {
 public:
  explicit RestingBall(const PairGeometry& geometry) : geometry_(geometry) {}
  PairState Start(uint64_t) override {
    return {.position = {-0.1, 0},
            .ball_speed = 0,
            .piston = geometry_.piston_right(),
            .piston_velocity = -1};
  }
  AfterContact Meet(uint64_t, const Contact&) override { return AfterContact::kEnd; }

 private:
  PairGeometry geometry_;
};

TEST(Orbits, StopEndsAFlightThatNeverComesToAWall) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  std::stop_source stop;
  stop.request_stop();
  for (const Engine engine : {Engine::kReference, Engine::kLanes, Engine::kLanesSingle}) {
    RestingBall source(geometry);
    EXPECT_FALSE(RunOrbits(engine, geometry, 3, source, stop.get_token()));
  }
}

}  // namespace
}  // namespace ballpiston
