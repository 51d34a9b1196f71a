#include "server/worker/lease_runner.h"

#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

// Keeps the chunks; requests a stop after a number of them.
class Recorder : public ChunkReceiver {
 public:
  explicit Recorder(size_t most = ~size_t{0}) : most_(most) {}

  void ChunkDone(ChunkResult chunk) override {
    chunks.push_back(std::move(chunk));
    if (--most_ == 0) stop.request_stop();
  }
  void Worked(double time) override { seconds += time; }

  bool Run(const Lease& lease) { return RunLease(lease, stop.get_token(), *this); }

  std::vector<uint64_t> Numbers() const {
    std::vector<uint64_t> numbers;
    for (const ChunkResult& chunk : chunks) numbers.push_back(chunk.chunk);
    return numbers;
  }

  std::stop_source stop;
  std::vector<ChunkResult> chunks;
  double seconds = 0;

 private:
  size_t most_;
};

TEST(LeaseRunner, ChunksHaveTheBitsOfAWholePoint) {
  for (const EnsembleSpec& spec : EverySampledSpec()) {
    SCOPED_TRACE(NameOf(spec));
    const Lease lease = LeaseOf(spec);
    Recorder recorder;
    EXPECT_TRUE(recorder.Run(lease));
    EXPECT_TRUE(AreEqual(recorder.chunks, AllChunks(*lease.experiment)));
    EXPECT_GT(recorder.seconds, 0);
    PointFold fold(*lease.experiment);
    for (const ChunkResult& chunk : recorder.chunks) fold.Add(chunk);
    EXPECT_EQ(fold.Merged(), FoldPoint(*lease.experiment));
  }
}

TEST(LeaseRunner, ComputesOnlyTheRestOfAChunkThatHasBlocks) {
  Lease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000), 1, 2);
  lease.start.blocks = 1;
  lease.start.merged = RunBlock(*lease.experiment, lease.experiment->plan().BlockAt(1, 0)).value();
  Recorder recorder;
  EXPECT_TRUE(recorder.Run(lease));
  EXPECT_TRUE(AreEqual(recorder.chunks, {AllChunks(*lease.experiment)[1]}));
}

TEST(LeaseRunner, StopsAtTheTolerance) {
  EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard);
  spec.target = {.tolerance = 0.003};
  const Lease lease = LeaseOf(spec);
  Recorder recorder;
  EXPECT_TRUE(recorder.Run(lease));
  EXPECT_GT(recorder.chunks.size(), 1u);
  PointFold fold(*lease.experiment);
  for (const ChunkResult& chunk : recorder.chunks) {
    EXPECT_FALSE(fold.finished());
    fold.Add(chunk);
  }
  EXPECT_TRUE(fold.finished());
  EXPECT_EQ(fold.Merged(), FoldPoint(*lease.experiment));
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
      Lease lease = LeaseOf(spec, chunk, chunk + 1);
      lease.groups.resize(groups);
      lease.groups[chunk % groups] = fold.StartOf(chunk);
      const auto received = LeaseOfRecord(RecordOf(lease));
      ASSERT_TRUE(received.ok()) << received.status();
      Recorder recorder;
      EXPECT_TRUE(RunLease(received->lease, recorder.stop.get_token(), recorder));
      fold.Add(recorder.chunks.at(0));
    }
    EXPECT_TRUE(fold.finished());
    EXPECT_EQ(fold.Merged(), FoldPoint(*experiment)) << Name(model);
  }
}

}  // namespace
}  // namespace ballpiston::server
