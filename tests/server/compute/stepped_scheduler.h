// A scheduler without threads, its runs of fake experiments, and a journal that records everything.
// A test drives the scheduler step by step, so every schedule can be repeated.
#pragma once

#include "server/compute/run_journal.h"
#include "tests/server/preamble.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- runs ----

class RecordingJournal : public RunJournal {
 public:
  void Began() override {}

  absl::StatusOr<StoredPoint> ReadPoint(size_t point) override {
    if (unreadable > 0) {
      --unreadable;
      return absl::UnavailableError("the disk cannot be read");
    }
    const auto state = stored.find(point);
    if (state == stored.end()) return StoredPoint();
    return StoredPoint{.state = StoredState{Model::kBilliard, state->second}};
  }

  uint64_t Merged(const MergedSamples& news) override {
    std::lock_guard lock(mutex);
    if (has_no_memory) throw std::bad_alloc();
    (news.restored ? restored : merged)[news.point] += news.samples;
    return ++changes;
  }

  void Checkpoint(size_t point, Model, const FoldState& state) override {
    std::lock_guard lock(mutex);
    checkpoints[point] = state;
  }

  void ChunkIsEarly(size_t point, Model, const ChunkResult& chunk) override {
    std::lock_guard lock(mutex);
    early[point].push_back(chunk);
  }

  void Worked(double seconds) override {
    std::lock_guard lock(mutex);
    work += seconds;
  }

  void PointFinished(size_t point, const PointExperiment&, const PointFold& fold) override {
    std::lock_guard lock(mutex);
    finished.emplace(point, fold.Merged());
  }

  void Ended(const absl::Status& status) override {
    std::lock_guard lock(mutex);
    outcome = status;
    ++ends;
  }

  double AwaitRoom() override { return await_room(); }

  void AwaitEnd() {  // if threads compute the run
    AwaitThat([this] {
      std::lock_guard lock(mutex);
      return outcome.has_value();
    });
  }

  std::map<size_t, FoldState> stored;  // set before the run: what an earlier process stored
  int unreadable = 0;                  // the first reads of points that fail
  std::function<double()> await_room = [] { return 0; };
  bool has_no_memory = false;  // to merge
  std::mutex mutex;
  int ends = 0;
  double work = 0;
  uint64_t changes = 0;
  std::map<size_t, uint64_t> merged;    // samples
  std::map<size_t, uint64_t> restored;  // likewise
  std::map<size_t, FoldState> checkpoints;
  std::map<size_t, std::vector<ChunkResult>> early;
  std::map<size_t, BlockResult> finished;
  std::optional<absl::Status> outcome;
};

using JournalPointer = std::shared_ptr<RecordingJournal>;

// Points of chunks 0 ... 5: 64, 128, 256, 512, 1024 and 1016 samples. One core takes 1.3 s, 2.7 s,
// 5.4 s, 10.7 s, 21.5 s and 21.3 s for them, so one point is just enough for an executor elsewhere.
inline constexpr uint64_t kChunks = 6;
inline EnsembleSpec SixChunks(int points = 1) {
  EnsembleSpec spec = FakeSpec(points, 1500);
  spec.model = Model::kBilliard;  // with a closed form a lease would open 128 points
  return spec;
}

inline RunRequest RunOf(int64_t key, const EnsembleSpec& spec, const JournalPointer& journal) {
  return {.key = key,
          .principal = "",
          .spec = spec,
          .finished = std::vector<bool>(PointCount(spec)),
          .journal = journal};
}

// Every point has the bytes that it has if it is computed in one place, and its samples were
// counted once.
inline void ExpectComplete(const EnsembleSpec& spec, RecordingJournal& journal) {
  ASSERT_EQ(journal.ends, 1);
  EXPECT_OK(*journal.outcome);
  ASSERT_EQ(journal.finished.size(), PointCount(spec));
  for (const auto& [point, merged] : journal.finished) {
    SCOPED_TRACE(point);
    EXPECT_TRUE(merged ==
                FakeMerged(spec, point, static_cast<uint64_t>(spec.target.samples.value_or(0))));
    EXPECT_EQ(journal.merged[point] + journal.restored[point], merged.samples);
  }
}

// ---- the scheduler ----

// A scheduler, and its two executors. The test takes the turns of a thread of this server. It also
// takes leases as an executor elsewhere, and decides which chunks of a lease are reported, how
// often and in which order, and whether the lease is returned.
struct SteppedScheduler {
  using Change = std::function<void(RunRequest& request, RecordingJournal& journal)>;

  explicit SteppedScheduler(std::unique_ptr<PointOpener> points,
                            const SchedulerOptions& options = {})
      : opener_(std::move(points)), scheduler_(*opener_, 1, options) {}
  explicit SteppedScheduler(ExperimentFactory factory = FakeExperiments(),
                            const SchedulerOptions& options = {})
      : SteppedScheduler(std::make_unique<FactoryOpener>(std::move(factory)), options) {}
  ~SteppedScheduler() { scheduler_.Shutdown(); }

  const std::unique_ptr<PointOpener> opener_;
  Scheduler scheduler_;

  // Adds a run, after a change of its request or of its journal.
  JournalPointer Add(int64_t key, const EnsembleSpec& spec, const Change& change = nullptr) {
    auto journal = std::make_shared<RecordingJournal>();
    RunRequest request = RunOf(key, spec, journal);
    if (change) change(request, *journal);
    request.has_checkpoints = !journal->stored.empty();
    scheduler_.Add(std::move(request));
    return journal;
  }

  // The same, and opens its first point.
  JournalPointer Opened(int64_t key, const EnsembleSpec& spec) {
    JournalPointer journal = Add(key, spec);
    EXPECT_TRUE(TakeTurn());
    return journal;
  }

  // ---- this server's thread ----

  // Begins a turn; empty if there is no lease now.
  std::optional<Lease> Begin() {
    return scheduler_.Next(
        {.share = [](const Lease& lease) { return std::make_shared<Fold>(lease); }});
  }

  // Opens the points of the lease, or computes at most `blocks` blocks of it. Ends the turn, which
  // took `seconds`.
  void End(const Lease& lease, uint64_t blocks, double seconds = 0) {
    for (const size_t point : lease.opens) scheduler_.Open(lease, point);
    if (!lease.OpensPoints()) Compute(lease, blocks);
    scheduler_.EndTurn(lease, seconds);
  }

  // A turn; false if there is no lease now.
  bool TakeTurn(uint64_t blocks = std::numeric_limits<uint64_t>::max()) {
    const std::optional<Lease> lease = Begin();
    if (lease) End(*lease, blocks);
    return lease.has_value();
  }

  void TakeAllTurns() {
    while (TakeTurn()) {
    }
  }

  // The runs of the next turns, in order; each turn computes at most so many blocks.
  std::vector<int64_t> Turns(int turns, uint64_t blocks) {
    std::vector<int64_t> runs;
    while (std::ssize(runs) < turns) {
      const auto lease = Begin();
      if (!lease) break;
      runs.push_back(lease->run);
      End(*lease, blocks);
    }
    return runs;
  }

  // ---- elsewhere ----

  // A lease has the fewest chunks that take `seconds`; a fake sample takes 0.02 s.
  std::optional<Lease> TakeElsewhere(double seconds = 0) {
    return scheduler_.Next({.local = false, .seconds = seconds});
  }
  std::vector<Lease> TakeAllElsewhere(double seconds = 0) {
    std::vector<Lease> leases;
    while (std::optional<Lease> lease = TakeElsewhere(seconds)) leases.push_back(*std::move(lease));
    return leases;
  }
  absl::Status Report(const Lease& lease, std::vector<ChunkResult> chunks) {
    return scheduler_.Report(lease, {.chunks = std::move(chunks)});
  }
  absl::Status ReportAll(const Lease& lease) { return Report(lease, ComputedChunks(lease)); }

 private:
  struct Fold : SharedWork {
    explicit Fold(const Lease& lease) : fold(lease.experiment->plan(), lease.start, lease.end) {}
    bool HasTurn() const override { return fold.HasNextBlock(); }

    ChunkFold fold;
  };

  void Compute(const Lease& lease, uint64_t blocks) {
    constexpr double kSecondsOfABlock = 1e-3;  // without work a shutdown has nothing to write
    ChunkFold& fold = static_cast<Fold&>(*lease.work).fold;
    while (blocks-- > 0 && !lease.stop.stop_requested()) {
      const std::optional<Block> block = fold.NextBlock();
      if (!block) break;
      LeaseReport report = {.chunks = fold.Add(*block, RunBlock(*lease.experiment, *block)),
                            .partial = fold.partial(),
                            .seconds = kSecondsOfABlock};
      EXPECT_OK(scheduler_.Report(lease, std::move(report)));
    }
  }
};

struct SchedulerTest : testing::Test, SteppedScheduler {
  using SteppedScheduler::SteppedScheduler;
};

}  // namespace ballpiston::server
