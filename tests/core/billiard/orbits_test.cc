#include "core/billiard/orbits.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "core/sampling/collision_surface.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/moments.h"
#include "tests/core/billiard/each_target.h"

namespace ballpiston {
namespace {

constexpr double kPaperRho = 0.529561127988977;

// Orbits of a few collisions from equilibrium; keeps every contact.
class Recorder : public OrbitSource {
 public:
  Recorder(const PairGeometry& geometry, uint64_t orbits, size_t collisions)
      : geometry_(geometry), collisions_(collisions), contacts_(orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(7, 8, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }

  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
    contacts_[orbit].push_back(contact);
    return contacts_[orbit].size() < collisions_ ? AfterContact::kGoOn : AfterContact::kEnd;
  }

  const std::vector<std::vector<Contact>>& contacts() const { return contacts_; }

  // FNV-1a over all that was told.
  uint64_t Hash() const {
    uint64_t hash = 0xcbf29ce484222325;
    const auto absorb = [&hash](uint64_t word) { hash = (hash ^ word) * 0x100000001b3; };
    for (const auto& orbit : contacts_) {
      for (const Contact& contact : orbit) {
        for (const double x :
             {contact.time, contact.state.position.x(), contact.state.position.y(),
              contact.state.direction.x(), contact.state.direction.y(), contact.state.ball_speed,
              contact.state.piston, contact.state.piston_velocity}) {
          absorb(std::bit_cast<uint64_t>(x));
        }
        absorb(contact.ball_wall_hits);
        absorb(contact.piston_wall_hits);
      }
    }
    return hash;
  }

 private:
  PairGeometry geometry_;
  size_t collisions_;
  std::vector<std::vector<Contact>> contacts_;
};

Recorder Recorded(Engine engine, const PairGeometry& geometry, uint64_t orbits, size_t collisions) {
  Recorder recorder(geometry, orbits, collisions);
  EXPECT_TRUE(RunOrbits(engine, geometry, orbits, recorder, {}));
  return recorder;
}

TEST(Orbits, EveryOrbitComesToItsEnd) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  for (const Engine engine : {Engine::kReference, Engine::kLanes, Engine::kLanesSingle}) {
    for (const uint64_t orbits : {1, 2, 47, 48, 49, 1000}) {
      const Recorder recorder = Recorded(engine, geometry, orbits, 3);
      for (const auto& contacts : recorder.contacts()) ASSERT_EQ(contacts.size(), 3u);
    }
  }
}

TEST(Orbits, ContactsAreOnTheCollisionSurfaceAndApproaching) {
  for (const double share : {1.0, 0.3, 0.03}) {
    const PairGeometry geometry =
        *PairGeometry::Create(kPaperRho, share * PairDeltaBound(kPaperRho));
    const Recorder recorder = Recorded(Engine::kLanes, geometry, 500, 4);
    for (const auto& contacts : recorder.contacts()) {
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

// The same bits whatever the width, with fused multiply-add; without it other bits, the same law.
TEST(Orbits, BitsAreTheSameUnderEveryTargetWithFusedMultiplyAdd) {
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  std::vector<uint64_t> doubles, singles;
  ForEachTarget([&](int64_t target) {
    if (!HasFusedMultiplyAdd(target)) return;
    doubles.push_back(Recorded(Engine::kLanes, geometry, 300, 5).Hash());
    singles.push_back(Recorded(Engine::kLanesSingle, geometry, 300, 5).Hash());
  });
  for (const uint64_t hash : doubles) EXPECT_EQ(hash, doubles.front());
  for (const uint64_t hash : singles) EXPECT_EQ(hash, singles.front());
}

// Times and counts of the two engines, from the same starts: 5 combined standard errors of 20,000
// flights each, 6e-7 false alarms a comparison.
TEST(Orbits, LanesAndReferenceAgreeInLaw) {
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho));
    Moments time[2], ball[2], piston[2], speed[2];
    const Engine engines[] = {Engine::kReference, Engine::kLanes};
    for (size_t i = 0; i < 2; ++i) {
      const Recorder recorder = Recorded(engines[i], geometry, 5000, 4);
      for (const auto& contacts : recorder.contacts()) {
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
    Recorder recorder(geometry, 10, 1);
    EXPECT_FALSE(RunOrbits(engine, geometry, 10, recorder, stop.get_token()));
  }
}

}  // namespace
}  // namespace ballpiston
