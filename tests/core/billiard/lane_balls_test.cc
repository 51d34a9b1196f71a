// Tests the records of FlyLaneBalls. single_flight_test.cc tests the flights themselves.
#include "tools/flows/lane_balls.h"

#include "tests/core/billiard/each_target.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr uint64_t kRecordedHits = 12;

PairGeometry Geometry() { return *PairGeometry::Create(kPaperRho, 0.1); }

// Balls on the middle of their disc's arc.
std::vector<LaneFrame> MiddleStarts(size_t count) {
  const double rho = Geometry().rho();
  std::vector<LaneFrame> starts;
  for (size_t i = 0; i < count; ++i) {
    CounterRandom random(17, 0, i);
    const double angle = (random.Uniform() - 0.5) * 3;  // between direction and normal
    const Eigen::Vector2d normal = Eigen::Vector2d(1, 1).normalized();
    const Eigen::Vector2d across(-normal.y(), normal.x());
    starts.push_back(FrameOfBallOnWall(Eigen::Vector2d(-0.5, -0.5) + rho * normal,
                                       std::cos(angle) * normal + std::sin(angle) * across));
  }
  return starts;
}

auto Bits(const LaneHit& hit) {
  const LaneFrame& f = hit.frame;
  return std::tuple(f.h, f.e, f.c, f.s, f.a, f.b, f.m, hit.length, hit.x);
}

std::vector<LaneHit> Flown(const std::vector<LaneFrame>& starts, size_t records) {
  std::vector<LaneHit> recorded(starts.size() * records);
  FlyLaneBalls(Geometry(), starts, kRecordedHits, recorded);
  return recorded;
}

TEST(LaneBalls, FewerRecordsAreEveryNthHit) {
  ForEachTarget([](int64_t) {
    const std::vector<LaneFrame> starts = MiddleStarts(100);
    const std::vector<LaneHit> all = Flown(starts, kRecordedHits);
    for (const size_t records : {size_t{1}, size_t{4}}) {
      const std::vector<LaneHit> some = Flown(starts, records);
      const size_t between = kRecordedHits / records;
      for (size_t i = 0; i < starts.size(); ++i) {
        for (size_t j = 0; j < records; ++j) {
          ASSERT_EQ(Bits(some[i * records + j]),
                    Bits(all[i * kRecordedHits + (j + 1) * between - 1]));
        }
      }
    }
  });
}

// The numbers of balls leave vectors, groups and batches incomplete, for vectors of 2 to 8 lanes.
TEST(LaneBalls, EachBallIsIndependentOfTheOthers) {
  ForEachTarget([](int64_t) {
    const std::vector<LaneFrame> starts = MiddleStarts(100);
    for (const size_t count : {1u, 5u, 7u, 13u, 25u, 49u, 100u}) {
      const std::vector<LaneFrame> some(starts.begin(),
                                        starts.begin() + static_cast<std::ptrdiff_t>(count));
      const std::vector<LaneHit> together = Flown(some, 1);
      for (size_t i = 0; i < count; ++i) {
        ASSERT_EQ(Bits(together[i]), Bits(Flown({starts[i]}, 1)[0])) << i << " of " << count;
      }
    }
  });
}

}  // namespace
}  // namespace ballpiston
