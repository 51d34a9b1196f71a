#include "server/worker/lease_runner.h"

#include <map>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;

// Keeps the chunks; requests a stop after a number of them.
class Recorder : public ChunkReceiver {
 public:
  explicit Recorder(size_t most = ~size_t{0}) : most_(most) {}

  void ChunkDone(size_t lease, ChunkResult chunk) override {
    chunks[lease].push_back(std::move(chunk));
    if (--most_ == 0) stop.request_stop();
  }
  void Worked(size_t lease, double time) override { seconds[lease] += time; }

  std::vector<uint64_t> Numbers(size_t lease) {
    std::vector<uint64_t> numbers;
    for (const ChunkResult& chunk : chunks[lease]) numbers.push_back(chunk.chunk);
    return numbers;
  }

  std::stop_source stop;
  std::map<size_t, std::vector<ChunkResult>> chunks;
  std::map<size_t, double> seconds;

 private:
  size_t most_;
};

TEST(LeaseRunner, ChunksHaveTheBitsOfAWholePoint) {
  std::vector<LeaseWork> work;
  for (const EnsembleSpec& spec : EverySampledSpec()) work.push_back({LeaseOf(spec).lease});
  Recorder recorder;
  EXPECT_TRUE(RunLeases(work, recorder.stop.get_token(), recorder));
  for (size_t i = 0; i < work.size(); ++i) {
    SCOPED_TRACE(NameOf(*work[i].lease.spec));
    const PointExperiment& experiment = *work[i].lease.experiment;
    EXPECT_TRUE(AreEqual(recorder.chunks[i], AllChunks(experiment)));
    EXPECT_GT(recorder.seconds[i], 0);
    PointFold fold(experiment);
    for (const ChunkResult& chunk : recorder.chunks[i]) fold.Add(chunk);
    EXPECT_EQ(fold.Merged(), FoldPoint(experiment));
  }
}

TEST(LeaseRunner, ComputesOnlyTheRestOfAChunkThatHasBlocks) {
  LeaseWork work = {LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000), 1, 2).lease};
  const PointExperiment& experiment = *work.lease.experiment;
  work.lease.start.blocks = 1;
  work.lease.start.merged = RunBlock(experiment, experiment.plan().BlockAt(1, 0)).value();
  Recorder recorder;
  EXPECT_TRUE(RunLeases({work}, recorder.stop.get_token(), recorder));
  EXPECT_TRUE(AreEqual(recorder.chunks[0], {AllChunks(experiment)[1]}));
}

TEST(LeaseRunner, ComputesOnlyMissingChunks) {
  LeaseWork work = {LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000), 0, 5).lease};
  const std::vector<ChunkResult> all = AllChunks(*work.lease.experiment);
  work.known = {all[3], all[1], all[3]};
  Recorder recorder;
  EXPECT_TRUE(RunLeases({work}, recorder.stop.get_token(), recorder));
  EXPECT_TRUE(AreEqual(recorder.chunks[0], {all[0], all[2], all[4]}));
}

TEST(LeaseRunner, StopsAtTheTolerance) {
  EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard);
  spec.target = {.tolerance = 0.003};
  LeaseWork work = {LeaseOf(spec).lease};
  const PointExperiment& experiment = *work.lease.experiment;
  Recorder recorder;
  EXPECT_TRUE(RunLeases({work}, recorder.stop.get_token(), recorder));
  EXPECT_GT(recorder.chunks[0].size(), 1u);
  PointFold fold(experiment);
  for (const ChunkResult& chunk : recorder.chunks[0]) {
    EXPECT_FALSE(fold.finished());
    fold.Add(chunk);
  }
  EXPECT_TRUE(fold.finished());
  EXPECT_EQ(fold.Merged(), FoldPoint(experiment));

  work.known = recorder.chunks[0];
  Recorder second;
  EXPECT_TRUE(RunLeases({work}, second.stop.get_token(), second));
  EXPECT_TRUE(second.chunks.empty());
}

// The judge needs all chunks of the point.
TEST(LeaseRunner, ALeaseOfLaterChunksIsComputedWhole) {
  EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard);
  spec.target = {.tolerance = 0.9};
  Recorder recorder;
  EXPECT_TRUE(RunLeases({{LeaseOf(spec, 2, 5).lease}}, recorder.stop.get_token(), recorder));
  EXPECT_THAT(recorder.Numbers(0), ElementsAre(2, 3, 4));
}

TEST(LeaseRunner, AStopLeavesTheChunksThatAreComplete) {
  const EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard, 100'000);
  Recorder recorder(2);
  EXPECT_FALSE(RunLeases({{LeaseOf(spec, 1, 6).lease}, {LeaseOf(spec).lease}},
                         recorder.stop.get_token(), recorder));
  EXPECT_EQ(recorder.chunks.size(), 1u);
  EXPECT_EQ(recorder.Numbers(0).front(), 1u);
  EXPECT_LT(recorder.Numbers(0).size(), 5u);
}

// Each lease has a chunk of one group, and travels as a message. The next chunk of the group starts
// with what the lease has reported.
TEST(LeaseRunner, LeasesContinueTheTrajectoriesOfASteadyState) {
  for (const Model model : kGasConduction.models) {
    const EnsembleSpec spec = SpecOf(kGasConduction, model, 600);
    const auto experiment = PointExperiment::Create(spec, 0);
    const uint64_t groups = experiment->plan().groups();
    PointFold fold(*experiment);
    for (uint64_t chunk = 0; chunk < experiment->plan().chunks(); ++chunk) {
      IdentifiedLease lease = LeaseOf(spec, chunk, chunk + 1);
      lease.lease.groups.resize(groups);
      lease.lease.groups[chunk % groups] = fold.StartOf(chunk);
      const auto received = LeaseOfRecord(LeaseRecord(lease.lease, lease.job));
      ASSERT_TRUE(received.ok()) << received.status();
      Recorder recorder;
      EXPECT_TRUE(RunLeases({{received->lease}}, recorder.stop.get_token(), recorder));
      fold.Add(recorder.chunks[0].at(0));
    }
    EXPECT_TRUE(fold.finished());
    EXPECT_EQ(fold.Merged(), FoldPoint(*experiment)) << Name(model);
  }
}

TEST(LeaseRunner, ALeaseWithoutTheStateOfItsGroupIsDamaged) {
  const IdentifiedLease lease =
      LeaseOf(SpecOf(kGasConduction, Model::kMarkov, 600), 16, 17);  // of the second stage
  EXPECT_EQ(LeaseOfRecord(LeaseRecord(lease.lease, lease.job)).status().code(),
            absl::StatusCode::kDataLoss);
}

// A task that starts again knows some chunks, from which later ones continue.
TEST(LeaseRunner, KnownChunksAreContinued) {
  LeaseWork work = {LeaseOf(SpecOf(kGasConduction, Model::kMarkov, 600)).lease};
  const std::vector<ChunkResult> all = AllChunks(*work.lease.experiment);
  work.known.assign(all.begin(), all.begin() + 20);
  Recorder recorder;
  EXPECT_TRUE(RunLeases({work}, recorder.stop.get_token(), recorder));
  EXPECT_TRUE(AreEqual(recorder.chunks[0], {all.begin() + 20, all.end()}));
}

}  // namespace
}  // namespace ballpiston::server
