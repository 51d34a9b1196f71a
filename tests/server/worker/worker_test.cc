#include "server/worker/worker.h"

#include "core/engine_version.h"
#include "tests/server/worker/fake_files.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

using std::chrono::duration;
using Clock = std::chrono::steady_clock;

const absl::Status kFull = absl::ResourceExhaustedError("no space left");

// A worker whose time passes while it sleeps.
class WorkerTest : public testing::Test {
 protected:
  void Lay(const std::string& name, const Lease& lease, double touch_seconds = 20) {
    files_.files["todo/" + name] = {FileOf(lease, touch_seconds), files_.now};
  }

  absl::Status Run(WorkerOptions options = {}) {
    if (options.name.empty()) options.name = "me";
    return Work(
        files_, options,
        {.now = [this] { return now_; },
         .sleep =
             [this](duration<double> time) {
               now_ += std::chrono::duration_cast<Clock::duration>(std::min(time, longest_sleep_));
             },
         .random_bits = [this] { return random_ += 0x9e3779b97f4a7c15; },
         .end = [this] { return end_; },
         .report = [this](absl::string_view line) { lines_.emplace_back(line); },
         .lease_begins = [this](const std::string& from,
                                const std::string&) { begun_.push_back(from); }});
  }

  // The chunks that a worker computes for the lease.
  std::vector<ChunkResult> Compute(const Lease& lease, double touch_seconds = 20) {
    Lay("a", lease, touch_seconds);
    EXPECT_OK(Run());
    return Computed("done/a.me.finished");
  }

  std::set<std::string> Names() const {
    std::set<std::string> names;
    for (const auto& [name, file] : files_.files) names.insert(name);
    return names;
  }

  std::vector<ChunkResult> Computed(const std::string& path) const {
    const LeaseReport report = ReportsIn(files_.files.at(path).bytes);
    EXPECT_GT(report.seconds, 0);
    return report.chunks;
  }

  const Lease lease_ = LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000));
  const std::vector<ChunkResult> chunks_ = ComputedChunks(lease_);
  FakeFiles files_;
  Clock::time_point now_ = {};
  duration<double> longest_sleep_{std::numeric_limits<double>::infinity()};
  uint64_t random_ = 0;
  EndOfWork end_ = EndOfWork::kNotYet;
  std::vector<std::string> lines_, begun_;
};

TEST_F(WorkerTest, ComputesAllLeasesAndEndsWhenThereAreNoMore) {
  Lay("a", lease_);
  Lay("b", LeaseOf(*lease_.spec, 1, 3));
  EXPECT_OK(Run());
  EXPECT_THAT(Names(), UnorderedElementsAre("done/a.me.finished", "done/b.me.finished"));
  EXPECT_TRUE(AreEqual(Computed("done/a.me.finished"), chunks_));
  EXPECT_TRUE(AreEqual(Computed("done/b.me.finished"), {chunks_[1], chunks_[2]}));
  EXPECT_GE(now_, Clock::time_point() + std::chrono::seconds(60));
  EXPECT_LE(now_, Clock::time_point() + std::chrono::seconds(90));
}

TEST_F(WorkerTest, AWorkerThatMustEndAfterItsChunkGivesItsLeaseBack) {
  Lay("a", lease_, 0);
  files_.Before("append", [this] {
    end_ = EndOfWork::kAfterChunk;
    return absl::OkStatus();
  });
  EXPECT_OK(Run());
  ASSERT_THAT(Names(), ElementsAre("done/a.me.returned"));
  const size_t computed = Computed("done/a.me.returned").size();
  EXPECT_GE(computed, 2u);  // the worker had already appended the first
  EXPECT_LT(computed, chunks_.size());
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(WorkerTest, AFolderThatIsAwayForAMomentIsReportedAndTheWorkGoesOn) {
  bool is_away = true;
  files_.before = [&](const std::string& operation, const std::string&) {
    const bool touches = operation == "touch" || operation == "append";
    return touches && std::exchange(is_away, false) ? absl::UnavailableError("gone")
                                                    : absl::OkStatus();
  };
  EXPECT_TRUE(AreEqual(Compute(lease_, 0), chunks_));
  EXPECT_THAT(lines_, ElementsAre("gone"));
}

TEST_F(WorkerTest, AFullFolderIsUsedAgainWhenItHasRoom) {
  int refusals = 3;
  files_.Before("append", [&] { return refusals-- > 0 ? kFull : absl::OkStatus(); });
  EXPECT_TRUE(AreEqual(Compute(lease_), chunks_));
  EXPECT_THAT(lines_, testing::Contains("no space left; retry in 5 s"));
}

// The two minutes hold even if waits end early.
TEST_F(WorkerTest, AWorkerThatMustEndAfterItsChunkWaitsTwoMinutesForRoom) {
  Lay("a", lease_);
  Clock::time_point first = {};
  files_.Before("append", [&] {
    if (end_ == EndOfWork::kNotYet) first = now_;
    end_ = EndOfWork::kAfterChunk;
    return kFull;
  });
  longest_sleep_ = duration<double>(0.1);
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_GE(now_ - first, std::chrono::minutes(2));
  EXPECT_LE(now_ - first, std::chrono::minutes(3));
}

TEST_F(WorkerTest, AWorkerThatMustEndNowStopsWaitingForRoom) {
  Lay("a", lease_);
  int attempts = 0;
  files_.Before("append", [&] {
    if (++attempts == 3) end_ = EndOfWork::kNow;
    return kFull;
  });
  EXPECT_OK(Run());
  EXPECT_EQ(attempts, 3);
  EXPECT_THAT(Names(), ElementsAre("taken/a.me"));
}

TEST_F(WorkerTest, ALeaseOfAnotherEngineStaysForOtherWorkers) {
  storage::Lease other = LeaseRecord(lease_, "a server", 20);
  other.set_engine_version("1.2.3");
  other.clear_question();  // the other engine may have other questions
  files_.files["todo/a"] = {BytesOf(other), files_.now};
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kUnimplemented,
                              AllOf(HasSubstr("1.2.3"), HasSubstr(kEngineVersion))));
  EXPECT_THAT(Names(), ElementsAre("todo/a"));
}

TEST_F(WorkerTest, DamagedAndForeignFilesAreGivenBack) {
  files_.files["todo/b"].bytes = "#!/bin/sh\necho this is a script of some length\n";
  for (const char* name : {"a", "c"}) Lay(name, lease_);
  files_.files["todo/a"].bytes[50] ^= 1;
  files_.files["todo/c"].bytes.resize(100);  // a kill of the machine has cut it
  storage::Lease strange = LeaseRecord(lease_, "a server", 20);
  strange.mutable_question()->set_model(77);
  static_assert(Name(static_cast<Model>(77)) == "unknown");
  files_.files["todo/d"] = {BytesOf(strange), files_.now};
  EXPECT_OK(Run());
  EXPECT_THAT(Names(), UnorderedElementsAre("done/a.me.returned", "done/b.me.returned",
                                            "done/c.me.returned", "done/d.me.returned"));
  EXPECT_THAT(begun_, IsEmpty());
}

TEST_F(WorkerTest, AFolderThatCannotBeReadIsReportedAtOnceAndWhenTheWorkerEnds) {
  files_.before = [](const char*, const std::string&) { return absl::UnavailableError("gone"); };
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kUnavailable, HasSubstr("gone")));
  EXPECT_THAT(lines_, ElementsAre("gone"));
}

// ---- the chunks of a lease ----

TEST_F(WorkerTest, ChunksHaveTheBitsOfAWholePoint) {
  for (const EnsembleSpec& spec : EverySampledSpec()) {
    SCOPED_TRACE(absl::StrCat(spec.experiment->name, " by ", Name(spec.model)));
    const Lease lease = LeaseOf(spec);
    EXPECT_TRUE(AreEqual(Compute(lease), ComputedChunks(lease)));
  }
}

// The merged block has a mark. If the worker computed all blocks, the mark would be missing.
TEST_F(WorkerTest, ComputesOnlyTheRestOfAChunkThatHasBlocks) {
  constexpr uint64_t kMark = 1000;
  Lease lease = LeaseOf(*lease_.spec, 1, 2);
  ChunkResult expected = chunks_[1];
  expected.result.health.escapes += kMark;
  lease.start.blocks = 1;
  lease.start.merged = RunBlock(*lease.experiment, lease.experiment->plan().BlockAt(1, 0));
  lease.start.merged.health.escapes += kMark;
  EXPECT_TRUE(AreEqual(Compute(lease), {expected}));
}

TEST_F(WorkerTest, StopsAtTheTolerance) {
  EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard);
  spec.target = {.tolerance = 0.003};
  const Lease lease = LeaseOf(spec);
  const std::vector<ChunkResult> chunks = Compute(lease);
  EXPECT_GT(chunks.size(), 1u);
  PointFold fold(*lease.experiment);
  for (const ChunkResult& chunk : chunks) {
    EXPECT_FALSE(fold.finished());
    fold.Add(chunk);
  }
  EXPECT_TRUE(fold.finished());
  EXPECT_EQ(fold.Merged(), FoldPoint(*lease.experiment));
}

}  // namespace
}  // namespace ballpiston::server
