#include "core/ensemble/collision_sampler.h"

#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

static_assert(!std::is_move_constructible_v<CollisionSampler>);

std::vector<CollisionRecord> AllRecords(
    const std::string& question, const std::function<bool()>& pause = [] { return false; }) {
  std::vector<CollisionRecord> all;
  const auto point = PointOf(question);
  CollisionSampler sampler(*point, *Asked(question).experiment, pause);
  while (const auto records = sampler.NextRecords()) {
    EXPECT_LT(records->size(), 65'536u);
    all.insert(all.end(), records->begin(), records->end());
  }
  return all;
}

// The collisions of an orbit are in the order of their times. Returns the number of orbits.
size_t OrbitsIn(const std::vector<CollisionRecord>& records) {
  size_t orbits = 0;
  for (size_t i = 0; i < records.size(); ++i) {
    const bool begins = records[i].time == records[i].free_time;
    EXPECT_TRUE(begins || records[i].time == records.at(i - 1).time + records[i].free_time) << i;
    orbits += begins;
  }
  return orbits;
}

TEST(CollisionSampler, TheSamplerHasTheCollisionsThatTheJobFolds) {
  for (const std::string question :
       {"first-hit delta=0.2 samples=20000 model=billiard_reference seed=3",
        "equilibrium delta=0.2 collisions=20000 model=billiard"}) {
    const std::vector<CollisionRecord> records = AllRecords(question);
    OrbitsIn(records);
    Moments times;
    for (const CollisionRecord& record : records) {
      ASSERT_EQ(record.sample, times.count);
      times.Add(record.free_time);
    }
    EXPECT_EQ(times.count, 20'000u);
    EXPECT_NEAR(times.mean / RunPoint(question).estimates.front().value, 1, 1e-12);
  }
}

// Few orbits have no collision. A block has more collisions than are kept at once.
TEST(CollisionSampler, CollisionsOfARelaxationHaveTheNumberOfTheirOrbit) {
  const auto records = AllRecords("energy-relaxation delta=0.3 samples=20000 model=billiard");
  std::set<uint64_t> numbers;
  for (const CollisionRecord& record : records) numbers.insert(record.sample);
  EXPECT_TRUE(std::ranges::is_sorted(records, {}, &CollisionRecord::sample));
  EXPECT_EQ(OrbitsIn(records), numbers.size());
  EXPECT_GT(numbers.size(), 19'900u);
  EXPECT_LT(*numbers.rbegin(), 20'000u);
}

// Nearly all orbits have no collision, so whole blocks have no record. A pause changes nothing.
TEST(CollisionSampler, BlocksWithoutCollisionsDoNotEndTheRecords) {
  const std::string question =
      "energy-relaxation delta=0.2 epsilon=1e-5 samples=2000 model=billiard";
  const std::vector<CollisionRecord> records = AllRecords(question);
  ASSERT_FALSE(records.empty());
  EXPECT_GT(records.back().sample, 1'000u);
  EXPECT_LT(records.back().sample, 2'000u);
  EXPECT_TRUE(std::ranges::is_sorted(records, {}, &CollisionRecord::sample));
  int calls = 0;
  const auto paused = AllRecords(question, [&calls] { return ++calls % 3 == 0; });
  ASSERT_EQ(paused.size(), records.size());
  for (size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(paused[i].sample, records[i].sample);
    EXPECT_EQ(paused[i].time, records[i].time);
  }
}

}  // namespace
}  // namespace ballpiston
