#include "server/compute/open_point.h"

#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr bool kElsewhere = false;

OpenPoint PointOf(const EnsembleSpec& spec) { return OpenPoint(FakeExperiments()(spec, 0)); }

// First chunk, chunk after the last, attempt.
using Range = std::tuple<uint64_t, uint64_t, int>;

std::optional<Range> Next(OpenPoint& point, double seconds, bool local = true,
                          double longest_chunk = kInfinity) {
  const auto lease =
      point.NextChunks({.local = local, .seconds = seconds, .longest_chunk = longest_chunk});
  if (!lease) return std::nullopt;
  return Range(lease->start.chunk, lease->end, lease->attempt);
}

std::optional<Range> Chunks(uint64_t first, uint64_t end, int attempt = 1) {
  return Range(first, end, attempt);
}

std::vector<ChunkResult> ChunksOf(const OpenPoint& point, uint64_t first, uint64_t end) {
  return ComputedChunks({.experiment = point.experiment(), .start = {.chunk = first}, .end = end});
}

void AddChunks(OpenPoint& point, uint64_t first, uint64_t end) {
  for (ChunkResult& chunk : ChunksOf(point, first, end)) point.fold().Add(std::move(chunk));
}

TEST(OpenPoint, AFiniteCapacityTakesTheFewestChunksThatFillIt) {
  OpenPoint point = PointOf(SixChunks());
  EXPECT_EQ(Next(point, 0), Chunks(0, 1));
  // Chunks 1 and 2 take 2.7 s and 5.4 s.
  EXPECT_EQ(Next(point, 5), Chunks(1, 3));
  EXPECT_EQ(Next(point, 1000), Chunks(3, 6));
  EXPECT_EQ(Next(point, 0), std::nullopt);
}

TEST(OpenPoint, ALeaseElsewhereContinuesTheBlocksOfAResumedPoint) {
  OpenPoint point = PointOf(SixChunks());
  const FoldState state = FakeState(SixChunks(), 0, 100);
  ASSERT_GT(state.blocks, 0u);  // of a chunk that is not complete
  ASSERT_OK(point.Resume({.state = StoredState{Model::kBilliard, state}}));
  const auto lease = point.NextChunks({.local = kElsewhere, .seconds = 0});
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease->start.chunk, state.chunk);
  EXPECT_EQ(lease->start.blocks, state.blocks);
  EXPECT_EQ(lease->start.merged, state.partial);
}

TEST(OpenPoint, ChunksThatArrivedEarlyAreSkipped) {
  for (const double seconds : {0., 1000., kInfinity}) {
    OpenPoint point = PointOf(SixChunks());
    AddChunks(point, 0, 1);
    AddChunks(point, 2, 3);
    std::vector<uint64_t> leased;
    while (const auto next = Next(point, seconds)) {
      for (uint64_t chunk = std::get<0>(*next); chunk < std::get<1>(*next); ++chunk) {
        leased.push_back(chunk);
      }
    }
    EXPECT_THAT(leased, testing::ElementsAre(1, 3, 4, 5)) << seconds << " s";
  }
}

// With a budget, the earlier process may have chosen it.
TEST(OpenPoint, StoredChunksAreNotLeasedAndThoseOfAnotherModelAreDropped) {
  OpenPoint point = PointOf(SixChunks());
  FoldState of_another_plan = FakeState(SixChunks(), 0, 100);
  of_another_plan.chunk = 100;
  StoredPoint stored = {.state = StoredState{Model::kMarkov, of_another_plan}};
  for (ChunkResult& chunk : ChunksOf(point, 1, 3)) {
    stored.chunks.push_back({Model::kMarkov, std::move(chunk)});
  }
  stored.chunks.push_back({Model::kBilliard, ChunksOf(point, 3, 4)[0]});
  ASSERT_OK(point.Resume(std::move(stored)));
  EXPECT_FALSE(point.fold().HasBlocks());
  EXPECT_EQ(Next(point, 1000), Chunks(0, 3));
  EXPECT_EQ(Next(point, 1000), Chunks(4, 6));
}

// Chunks with crashes are a lease of their own.
TEST(OpenPoint, ReturnedChunksComeFirstAndKeepTheirAttempt) {
  OpenPoint point = PointOf(SixChunks());
  EXPECT_EQ(Next(point, 15), Chunks(0, 4));
  AddChunks(point, 0, 1);
  AddChunks(point, 2, 3);
  point.Return(0, 3, 2);
  point.Return(3, 4, 2, 1);
  EXPECT_EQ(Next(point, 1000), Chunks(1, 2, 2));
  const auto crashed = point.NextChunks({.seconds = 1000});
  ASSERT_TRUE(crashed);
  EXPECT_EQ(crashed->start.chunk, 3u);
  EXPECT_EQ(crashed->end, 4u);
  EXPECT_EQ(crashed->crashes, 1);
  EXPECT_EQ(Next(point, 1000), Chunks(4, 6, 1));
}

TEST(OpenPoint, ALeaseTakesNoMoreMemoryThanThereIs) {
  OpenPoint point = PointOf(SixChunks());
  point.memory = {.of_one_turn = 100};
  EXPECT_FALSE(point.AwaitsMemory({.memory = 100}));
  EXPECT_TRUE(point.AwaitsMemory({.memory = 99}));
  EXPECT_FALSE(point.NextChunks({.memory = 99}));
  EXPECT_FALSE(point.NextChunks({.local = false, .seconds = 0, .memory = 99}));
  EXPECT_TRUE(point.NextChunks({.local = false, .seconds = 0, .memory = 100}));
  EXPECT_TRUE(point.NextChunks({.memory = 100}));
  EXPECT_FALSE(point.AwaitsMemory({.memory = 99}));  // nothing is left
}

TEST(OpenPoint, AChunkOfTooManyAttemptsIsForLocalExecutors) {
  OpenPoint point = PointOf(SixChunks());
  EXPECT_EQ(Next(point, 0, kElsewhere), Chunks(0, 1));
  point.Return(0, 1, 5);
  EXPECT_EQ(Next(point, 0, kElsewhere), Chunks(0, 1, 5));
  point.Return(0, 1, 6);
  EXPECT_EQ(Next(point, 0, kElsewhere), Chunks(1, 2));
  EXPECT_EQ(Next(point, 0), Chunks(0, 1, 6));
}

TEST(OpenPoint, ALongChunkIsForLocalExecutors) {
  for (const double seconds : {0., 1000., kInfinity}) {
    OpenPoint point = PointOf(SixChunks());
    constexpr double kLongest = 15;  // chunk 3 takes 10.7 s, chunk 4 takes 21.5 s
    uint64_t end = 0;
    while (const auto next = Next(point, seconds, kElsewhere, kLongest)) end = std::get<1>(*next);
    EXPECT_EQ(end, 4u) << seconds << " s";
    EXPECT_EQ(Next(point, 1000), Chunks(4, 6));
  }
}

// ---- a tolerance ----

EnsembleSpec WithTolerance() {
  EnsembleSpec spec = FakeSpec(1, 0);
  spec.target = {.tolerance = 0.05};
  return spec;
}

// The variance of these samples is larger than expected.
void AddScatteredChunks(OpenPoint& point, uint64_t first, uint64_t end) {
  for (ChunkResult& chunk : ChunksOf(point, first, end)) {
    chunk.result.moments[0].m2 *= 1e4;
    point.fold().Add(std::move(chunk));
  }
}

TEST(OpenPoint, BeyondTheExpectedEndChunksComeOneByOne) {
  OpenPoint point = PointOf(WithTolerance());
  const uint64_t chunk = point.experiment()->expected_chunks();
  ASSERT_LT(chunk + 1, point.experiment()->plan().chunks());
  EXPECT_EQ(Next(point, 1e6), Chunks(0, chunk));
  EXPECT_EQ(Next(point, 1e6), std::nullopt);
  for (uint64_t next = chunk; next < chunk + 2; ++next) {
    AddScatteredChunks(point, next == chunk ? 0 : next - 1, next);
    EXPECT_EQ(Next(point, 1e6), Chunks(next, next + 1));
    EXPECT_EQ(Next(point, 1e6), std::nullopt);
  }
}

// The point has more than 64 chunks of one sample.
TEST(OpenPoint, FarBeyondTheExpectedEndAnEighthIsLeased) {
  OpenPoint point(PointExperiment::Create({.experiment = &kEquilibrium,
                                           .grid = {{kRho, {0.53}}, {kDelta, {1e-5}}},
                                           .target = {.tolerance = 0.1},
                                           .model = Model::kBilliard},
                                          0));
  ASSERT_LT(point.experiment()->expected_chunks(), 2048u);
  FoldState state = {.chunk = 2048, .complete = point.experiment()->EmptyResult()};
  state.complete.samples = 2048;
  point.fold().Resume(std::move(state));
  EXPECT_EQ(Next(point, 1e12), Chunks(2048, 2304));
}

// ---- samples that continue each other ----

std::shared_ptr<const PointExperiment> SteadyExperiment() {
  return PointExperiment::Create(SteadySpec({.samples = 1000}), 0);
}

TEST(OpenPoint, GroupsOfTrajectoriesAreLeasesOfTheirOwn) {
  OpenPoint point(SteadyExperiment());
  std::vector<Lease> leases;
  while (auto lease = point.NextChunks({.local = false, .seconds = 1000})) leases.push_back(*lease);
  ASSERT_EQ(leases.size(), 16u);  // the other chunks have no start yet
  for (uint64_t group = 0; group < 16; ++group) {
    EXPECT_EQ(leases[group].start.chunk, group);
    EXPECT_EQ(leases[group].end, group + 1);
  }
  point.Return(5, 6, 2);
  EXPECT_EQ(Next(point, 1000, kElsewhere), Chunks(5, 6, 2));
  const ChunkResult first = ComputedChunks(leases[0]).front();
  point.fold().Add(first);
  const auto next = point.NextChunks({.local = false, .seconds = 1000});
  ASSERT_TRUE(next);
  EXPECT_EQ(next->start.chunk, 16u);
  EXPECT_EQ(next->groups[0], first.result.groups[0]);
  EXPECT_FALSE(point.NextChunks({.local = false, .seconds = 1000}));
}

}  // namespace
}  // namespace ballpiston::server
