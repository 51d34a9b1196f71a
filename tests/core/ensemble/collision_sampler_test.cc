#include "core/ensemble/collision_sampler.h"

#include "core/ensemble/point_fold.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

static_assert(!std::is_move_constructible_v<CollisionSampler>);

std::vector<CollisionRecord> AllRecords(
    const PointExperiment& point, const ExperimentKind& kind,
    const std::function<bool()>& pause = [] { return false; }) {
  std::vector<CollisionRecord> all;
  CollisionSampler sampler(point, kind, pause);
  while (const auto records = sampler.NextRecords()) {
    EXPECT_LT(records->size(), 65'536u);
    all.insert(all.end(), records->begin(), records->end());
  }
  return all;
}

TEST(CollisionSampler, ReturnsAreThoseThatTheJobFolds) {
  const auto point =
      PointExperiment::Create(SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, 1), {.samples = 20'000},
                                     Model::kBilliardReference, 3),
                              0);
  Moments times;
  for (const CollisionRecord& record : AllRecords(*point, kFirstHit)) {
    ASSERT_EQ(record.sample, times.count);
    times.Add(record.time);
  }
  const Moments folded = FoldPoint(*point).moments.front();
  EXPECT_EQ(times.count, folded.count);
  EXPECT_NEAR(times.mean / folded.mean, 1, 1e-12);
}

TEST(CollisionSampler, CollisionsInEquilibriumAreInTheOrderOfTheirOrbits) {
  const auto point = PointExperiment::Create(
      SpecOf(&kEquilibrium, PaperPoint(0.2), {.collisions = 30'000}, Model::kBilliard), 0);
  const std::vector<CollisionRecord> records = AllRecords(*point, kEquilibrium);
  ASSERT_EQ(records.size(), 30'000u);
  Moments times;
  for (size_t i = 0; i < records.size(); ++i) {
    const CollisionRecord& record = records[i];
    ASSERT_EQ(record.sample, i);
    const bool begins = record.time == record.free_time;
    ASSERT_TRUE(begins || record.time == records[i - 1].time + record.free_time);
    times.Add(record.free_time);
  }
  const Estimate estimate = point->FirstEstimate(FoldPoint(*point));
  EXPECT_NEAR(times.mean / estimate.value, 1, 1e-12);
}

// An orbit's collisions have its number, and are in the order of their times. Few orbits have no
// collision. A block has more collisions than are kept at once.
TEST(CollisionSampler, CollisionsOfARelaxationHaveTheNumberOfTheirOrbit) {
  const auto point = PointExperiment::Create(
      SpecOf(&kEnergyRelaxation, PaperPoint(0.3), {.samples = 20'000}, Model::kBilliard), 0);
  const std::vector<CollisionRecord> all = AllRecords(*point, kEnergyRelaxation);
  uint64_t orbits = 1;
  for (size_t i = 1; i < all.size(); ++i) {
    const CollisionRecord &record = all[i], &previous = all[i - 1];
    const bool begins = record.time == record.free_time;
    ASSERT_TRUE(begins || record.time == previous.time + record.free_time);
    ASSERT_TRUE(begins ? record.sample > previous.sample : record.sample == previous.sample);
    orbits += begins;
  }
  EXPECT_LT(all.back().sample, 20'000u);
  EXPECT_GT(orbits, 19'900u);
}

// Nearly all orbits have no collision, so whole blocks have no record. A pause changes nothing.
TEST(CollisionSampler, BlocksWithoutCollisionsDoNotEndTheRecords) {
  const auto point = PointExperiment::Create(
      SpecOf(&kEnergyRelaxation, PaperPoint(0.2, 1e-5), {.samples = 2'000}, Model::kBilliard), 0);
  const std::vector<CollisionRecord> records = AllRecords(*point, kEnergyRelaxation);
  ASSERT_FALSE(records.empty());
  EXPECT_GT(records.back().sample, 1'000u);
  EXPECT_LT(records.back().sample, 2'000u);
  EXPECT_TRUE(std::ranges::is_sorted(records, {}, &CollisionRecord::sample));
  int calls = 0;
  const std::vector<CollisionRecord> paused =
      AllRecords(*point, kEnergyRelaxation, [&calls] { return ++calls % 3 == 0; });
  ASSERT_EQ(paused.size(), records.size());
  for (size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(paused[i].sample, records[i].sample);
    EXPECT_EQ(paused[i].time, records[i].time);
  }
}

}  // namespace
}  // namespace ballpiston
