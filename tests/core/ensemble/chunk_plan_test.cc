#include "core/ensemble/chunk_plan.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr uint64_t kMany = 1'000'000'000'000;

// Samples that continue each other: 16 groups of 4 trajectories, whose warm-up takes two stretches.
constexpr Trajectories kSome = {.groups = 16, .each = 4, .warm_up = 2};

// Returns the samples of all chunks.
uint64_t SamplesOfContiguousBlocks(const ChunkPlan& plan) {
  uint64_t covered = 0;
  for (uint64_t chunk = 0; chunk < plan.chunks(); ++chunk) {
    EXPECT_EQ(plan.FirstSample(chunk), covered);
    EXPECT_GE(plan.BlocksIn(chunk), 1u);
    for (uint64_t i = 0; i < plan.BlocksIn(chunk); ++i) {
      const Block block = plan.BlockAt(chunk, i);
      EXPECT_EQ(block.first, covered);
      EXPECT_GE(block.samples, 1u);
      covered += block.samples;
    }
  }
  return covered;
}

TEST(ChunkPlan, CoversEverySampleOnce) {
  for (const uint64_t samples : {1u, 2u, 63u, 64u, 65u, 1000u, 100'003u}) {
    for (const double events : {1.0, 37.0, 1e4, 1e9, 1e12, 1e300, double{INFINITY}}) {
      for (const Engine engine : {Engine::kReference, Engine::kLanes}) {
        EXPECT_EQ(SamplesOfContiguousBlocks({samples, engine, events}), samples);
      }
      const ChunkPlan plan(samples, Engine::kLanes, events, kSome);
      EXPECT_EQ(SamplesOfContiguousBlocks(plan), plan.samples());
      EXPECT_EQ(plan.samples() % kSome.count(), 0u);
      EXPECT_GE(plan.samples() - plan.warm_up(), samples);
      EXPECT_LT(plan.samples() - plan.warm_up(), samples + kSome.count());
    }
  }
  EXPECT_EQ(ChunkPlan().chunks(), 0u);  // an answer without samples
}

// Fewer than 64 samples are not enough to estimate an error.
TEST(ChunkPlan, ChunksDoubleFrom64SamplesUpToAMinute) {
  EXPECT_EQ(ChunkPlan(kMany, Engine::kLanes, 1e8).SamplesIn(0), 64u);
  EXPECT_EQ(ChunkPlan(kMany, Engine::kLanes, 0x1p10).SamplesIn(0), 1024u);
  EXPECT_EQ(ChunkPlan(kMany, Engine::kReference, 0x1p8).SamplesIn(0), 256u);
  for (const double events : {1.0, 100.0, 1e5, 1e7, 1e9}) {
    const ChunkPlan plan(kMany, Engine::kLanes, events);
    uint64_t chunk = 0;
    EXPECT_TRUE(std::has_single_bit(plan.SamplesIn(0)));
    while (plan.SamplesIn(chunk + 1) == 2 * plan.SamplesIn(chunk)) ++chunk;
    EXPECT_EQ(plan.SamplesIn(chunk + 1), plan.SamplesIn(chunk));
    const double seconds = 2.5e-9 * events * static_cast<double>(plan.SamplesIn(chunk));
    EXPECT_LE(seconds, 60);
    EXPECT_GT(seconds, 20);
  }
}

// A chunk of hours could not be resumed, and would hide the progress of a job. Its tolerance is
// judged where it would be judged with chunks of 64 samples.
TEST(ChunkPlan, ChunksOfLongSamplesTakeAMinuteOrHaveOneSample) {
  for (const Engine engine : {Engine::kReference, Engine::kLanes}) {
    for (const double events : {0x1p25, 0x1p28, 1e9, 0x1p33, 0x1p37, 1e15, double{INFINITY}}) {
      const ChunkPlan plan(kMany, engine, events);
      const auto in_a_chunk = static_cast<double>(plan.SamplesIn(0));
      EXPECT_TRUE(in_a_chunk == 1 || plan.SecondsFor(in_a_chunk) <= 60) << events;
      uint64_t judged = 0;
      for (uint64_t chunk = 0; chunk < 200; ++chunk) {
        const uint64_t samples = plan.FirstSample(chunk + 1);
        if (plan.SamplesIn(0) < 64) {
          EXPECT_EQ(plan.IsJudgedAfter(chunk), samples % 64 == 0);
        }
        if (plan.IsJudgedAfter(chunk)) ++judged;
      }
      EXPECT_GE(judged, 3u);
      EXPECT_EQ(plan.SamplesBefore(plan.ChunksFor(65)) % 64, 0u);
      EXPECT_GE(plan.SamplesBefore(plan.ChunksFor(65)), 128u);
    }
  }
}

TEST(ChunkPlan, AChunkHas32BlocksOfFiftyMillisecondsAtMost) {
  for (const double events : {1.0, 100.0, 1e5, 1e7, 1e8}) {
    const ChunkPlan plan(kMany, Engine::kLanes, events);
    for (uint64_t chunk = 0; chunk < 30; ++chunk) {
      EXPECT_GE(plan.BlocksIn(chunk), 32u);
      const Block block = plan.BlockAt(chunk, 0);
      EXPECT_TRUE(block.samples == 1 || static_cast<double>(block.samples) * events <= 0x1p24);
    }
  }
}

// The number of chunks is a multiple of a stage, which has a chunk of each group.
TEST(ChunkPlan, ChunksForIsTheFewestThatHoldTheRequestedSamples) {
  for (const ChunkPlan& plan :
       {ChunkPlan(1'000'000, Engine::kLanes, 1e7), ChunkPlan(kMany, Engine::kLanes, 1e4, kSome),
        ChunkPlan(kMany, Engine::kLanes, 1e9, kSome)}) {
    const uint64_t stage = std::max<uint64_t>(plan.groups(), 1);
    const auto measured_in = [&](uint64_t chunks) {
      return static_cast<double>(plan.SamplesBefore(chunks)) - static_cast<double>(plan.warm_up());
    };
    for (const double samples : {1.0, 64.0, 65.0, 192.0, 193.0, 5000.0, 77'777.0, 1e6, 1e9}) {
      const uint64_t chunks = plan.ChunksFor(samples);
      EXPECT_EQ(chunks % stage, 0u);
      EXPECT_TRUE(measured_in(chunks) >= samples || chunks == plan.chunks()) << samples;
      EXPECT_TRUE(chunks == stage || measured_in(chunks - stage) < samples) << samples;
    }
  }
}

// ---- samples that continue each other ----

TEST(ChunkPlan, EveryStageHasAnEqualChunkOfEachGroupAndIsJudged) {
  for (const double events : {1.0, 1e7, 1e9, 1e12}) {
    const ChunkPlan plan(1000, Engine::kLanes, events, kSome);
    ASSERT_EQ(plan.chunks() % 16, 0u);
    for (uint64_t chunk = 0; chunk < plan.chunks(); ++chunk) {
      EXPECT_EQ(plan.BlocksIn(chunk), 1u);
      EXPECT_EQ(plan.SamplesIn(chunk), plan.SamplesIn(chunk - chunk % 16));
      const bool is_judged = (chunk + 1) % 16 == 0 && plan.FirstSample(chunk + 1) > plan.warm_up();
      EXPECT_EQ(plan.IsJudgedAfter(chunk), is_judged);
    }
  }
}

TEST(ChunkPlan, StretchesAfterTheWarmUpDoubleUpToAMinute) {
  const ChunkPlan quick(kMany, Engine::kLanes, 1e4, kSome);
  EXPECT_EQ(quick.SamplesIn(0), 4u * 3);
  for (const uint64_t stage : {1, 2, 5, 9}) {
    EXPECT_EQ(quick.SamplesBefore(16 * (stage + 1)) - quick.warm_up(), 64u << stage);
  }
  const ChunkPlan slow(kMany, Engine::kLanes, 2e9, kSome);
  for (const uint64_t chunk : {0, 16, 16 * 30}) {
    EXPECT_EQ(slow.SamplesIn(chunk), 4u * 2);
    EXPECT_LE(slow.SecondsFor(4 * 2), 60);
  }
}

}  // namespace
}  // namespace ballpiston
