// Random schedules: a local executor and two elsewhere, losses, damage, cancellations, shutdowns
// and crashes. Every finished point has the bytes that it has if it is computed in one place.
//
// A schedule is a sequence of processes. Each process continues from what the journals of the one
// before it have stored, and may adopt the leases that executors elsewhere still have. A schedule
// follows from its seed, so a failure can be repeated.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/nightly.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

// The same numbers with every standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : bits_(seed) {}

  uint64_t Below(uint64_t end) { return bits_() % end; }
  bool Happens(uint64_t once_in) { return Below(once_in) == 0; }

  template <typename T>
  void Shuffle(std::vector<T>& values) {
    for (size_t left = values.size(); left > 1; --left) {
      std::swap(values[left - 1], values[Below(left)]);
    }
  }

 private:
  std::mt19937_64 bits_;
};

// Few of them, so that their right results can be remembered.
EnsembleSpec RandomSpec(Random& random) {
  EnsembleSpec spec = FakeSpec(1 + static_cast<int>(random.Below(4)), 1500, 1 + random.Below(3));
  spec.model = Model::kBilliard;
  switch (random.Below(4)) {
    case 0:
      spec.target = {.tolerance = 0.02};
      break;
    case 1:
      spec.target.samples = 4000;  // with several chunks of the full size
      break;
    default:
      break;
  }
  return spec;
}

const BlockResult& RightResult(const EnsembleSpec& spec, size_t point) {
  static std::map<std::tuple<uint64_t, int64_t, size_t>, BlockResult> known;
  const auto key = std::tuple(spec.seed, spec.target.samples.value_or(0), point);
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  return known.emplace(key, ComputedInOnePlace(spec, point)).first->second;
}

// What a store has of a run.
struct StoredRun {
  std::map<size_t, FoldState> checkpoints;
  std::map<size_t, std::map<uint64_t, ChunkResult>> chunks;
  std::map<size_t, BlockResult> results;

  // In the order in which a store keeps them: a checkpoint drops the chunks that it contains, a
  // result drops both.
  void Keep(const RecordingJournal& journal) {
    for (const auto& [point, early] : journal.early) {
      for (const ChunkResult& chunk : early) chunks[point].try_emplace(chunk.chunk, chunk);
    }
    for (const auto& [point, state] : journal.checkpoints) {
      checkpoints[point] = state;
      std::erase_if(chunks[point], [&](const auto& chunk) { return chunk.first < state.chunk; });
    }
    for (const auto& [point, result] : journal.finished) {
      results.emplace(point, result);
      checkpoints.erase(point);
      chunks.erase(point);
    }
  }
};

struct RandomRun {
  int64_t key = 0;
  EnsembleSpec spec;
  StoredRun stored;
  bool is_cancelled = false;
  JournalPointer journal;  // of the process

  bool HasEnded() const { return journal->ends > 0; }
};

// A lease that an executor elsewhere has, or had.
struct TakenLease {
  Lease lease;
  std::shared_ptr<const PointExperiment> experiment;
  PartialChunk start;
  std::vector<ChunkResult> chunks = {};  // as soon as they are computed
};

// One life of the server.
class Process {
 public:
  Process(Random& random, std::vector<RandomRun>& runs)
      : random_(random),
        runs_(runs),
        opener_(FakeExperiments()),
        scheduler_(opener_, 1),
        local_(scheduler_, random.Happens(2) ? kInfinity : 4) {
    for (auto& remote : remotes_) {
      const double longest_chunk = random_.Happens(3) ? 25 : kInfinity;
      const auto seconds = static_cast<double>(random_.Below(60));
      remote = std::make_unique<RemoteExecutor>(scheduler_, seconds, longest_chunk);
    }
    for (RandomRun& run : runs_) AddRun(run);
  }
  ~Process() { scheduler_.Shutdown(); }

  // Chunks of these leases may still be reported.
  void KeepLeases(std::vector<TakenLease> earlier) { ended_ = std::move(earlier); }

  void Step() {
    switch (random_.Below(16)) {
      case 0:
      case 1:
      case 2:
        local_.TakeTurn(1 + random_.Below(60), 0.05);
        break;
      case 3:
      case 4:
      case 5:
      case 6:
        Take();
        break;
      case 7:
      case 8:
      case 9:
      case 10:
        ReportSome(taken_);
        break;
      case 11:
        EndLease(true);
        break;
      case 12:
        EndLease(false);
        break;
      case 13:
      case 14:
        ReportSome(ended_);
        break;
      default:
        MayCancel();
    }
  }

  // Every lease elsewhere ends, most without a result; the local executor computes the rest.
  void Finish() {
    while (!taken_.empty()) EndLease(random_.Happens(3));
    for (const auto& remote : remotes_) {
      // A run may be too large to be finished here alone while an executor elsewhere is hungry.
      if (const auto lease = remote->Take()) remote->Return(*lease, false);
    }
    local_.TakeAllTurns();
  }

  bool HasEnded() const {
    for (const RandomRun& run : runs_) {
      if (!run.HasEnded()) return false;
    }
    return true;
  }

  // What a later process finds. A crash writes no checkpoints.
  std::vector<TakenLease> Stop(bool is_crash) {
    if (is_crash) Store();
    scheduler_.Shutdown();
    if (!is_crash) Store();
    return std::move(taken_);
  }

  int leases_elsewhere() const { return leases_elsewhere_; }

 private:
  void Store() {
    for (RandomRun& run : runs_) run.stored.Keep(*run.journal);
  }

  void AddRun(RandomRun& run) {
    run.journal = std::make_shared<RecordingJournal>();
    run.journal->stored = run.stored.checkpoints;
    for (const auto& [point, chunks] : run.stored.chunks) {
      for (const auto& [number, chunk] : chunks) run.journal->stored_chunks[point].push_back(chunk);
    }
    RunRequest request = RunOf(run.key, run.spec, run.journal);
    request.principal = absl::StrCat("principal ", run.key % 2);
    for (const auto& [point, result] : run.stored.results) request.finished[point] = true;
    scheduler_.Add(std::move(request));
  }

  RemoteExecutor& ExecutorOf(const Lease& lease) {
    return *remotes_[lease.executor == remotes_[0]->number() ? 0 : 1];
  }

  void Take() {
    const std::optional<Lease> lease = remotes_[random_.Below(2)]->Take();
    if (!lease) return;
    EXPECT_FALSE(lease->OpensPoints());
    EXPECT_LE(lease->attempt, 5);
    ++leases_elsewhere_;
    taken_.push_back({*lease, lease->experiment, lease->start});
  }

  static void Compute(TakenLease& taken) {
    if (!taken.chunks.empty()) return;
    Lease lease = taken.lease;
    lease.start = taken.start;
    taken.chunks = ComputedChunks(lease, *taken.experiment);
  }

  // Some chunks of a lease, in any order, some of them damaged.
  void ReportSome(std::vector<TakenLease>& leases) {
    if (leases.empty()) return;
    TakenLease& taken = leases[random_.Below(leases.size())];
    Compute(taken);
    std::vector<ChunkResult> chunks = taken.chunks;
    random_.Shuffle(chunks);
    chunks.resize(1 + random_.Below(chunks.size()));
    const bool is_damaged = random_.Happens(6);
    if (is_damaged) Damage(chunks[0]);
    const absl::Status reported = ExecutorOf(taken.lease).Report(taken.lease, std::move(chunks));
    const bool is_unopened = absl::IsUnavailable(reported);
    EXPECT_TRUE(reported.ok() || is_unopened || (is_damaged && absl::IsDataLoss(reported)))
        << reported;
  }

  void Damage(ChunkResult& chunk) {
    switch (random_.Below(3)) {
      case 0:
        chunk = WithAnotherHistogram(chunk);
        break;
      case 1:
        chunk = WithTooManySamples(chunk);
        break;
      default:
        chunk = WithNumber(chunk, 1'000'000 + chunk.chunk);
    }
  }

  // Its chunks are all reported before, or they are lost, or come late.
  void EndLease(bool is_complete) {
    if (taken_.empty()) return;
    const size_t which = random_.Below(taken_.size());
    TakenLease taken = std::move(taken_[which]);
    taken_.erase(taken_.begin() + static_cast<ptrdiff_t>(which));
    if (is_complete) {
      Compute(taken);
      ExecutorOf(taken.lease).Report(taken.lease, taken.chunks).IgnoreError();  // may be unopened
    }
    ExecutorOf(taken.lease).Return(taken.lease, !random_.Happens(4));
    ended_.push_back(std::move(taken));
  }

  void MayCancel() {
    if (!random_.Happens(12)) return;
    RandomRun& run = runs_[random_.Below(runs_.size())];
    if (run.HasEnded()) return;
    run.is_cancelled = true;
    scheduler_.Cancel(run.key);
    EXPECT_EQ(run.journal->ends, 1);  // nobody has a turn
  }

  Random& random_;
  std::vector<RandomRun>& runs_;
  FactoryOpener opener_;
  Scheduler scheduler_;
  SteppedExecutor local_;
  std::unique_ptr<RemoteExecutor> remotes_[2];
  std::vector<TakenLease> taken_;
  std::vector<TakenLease> ended_;
  int leases_elsewhere_ = 0;
};

void ExpectSamplesCountOnce(const RecordingJournal& journal) {
  for (const auto& [point, merged] : journal.finished) {
    const auto samples = [point = point](const std::map<size_t, uint64_t>& counts) {
      const auto found = counts.find(point);
      return found == counts.end() ? 0 : found->second;
    };
    EXPECT_EQ(samples(journal.merged) + samples(journal.restored), merged.samples)
        << "point " << point;
  }
}

void ExpectRight(const RandomRun& run) {
  ASSERT_TRUE(run.journal->outcome) << "run " << run.key << " is stuck";
  if (run.is_cancelled) {
    EXPECT_THAT(*run.journal->outcome, StatusIs(absl::StatusCode::kCancelled));
  } else {
    EXPECT_OK(*run.journal->outcome);
    EXPECT_EQ(run.stored.results.size(), PointCount(run.spec));
  }
  for (const auto& [point, merged] : run.stored.results) {
    EXPECT_TRUE(merged == RightResult(run.spec, point)) << "run " << run.key << " point " << point;
  }
}

// Returns the number of leases that went elsewhere.
int PlaySchedule(uint64_t seed) {
  Random random(seed);
  std::vector<RandomRun> runs(1 + random.Below(3));
  for (size_t i = 0; i < runs.size(); ++i) {
    runs[i].key = static_cast<int64_t>(i) + 1;
    runs[i].spec = RandomSpec(random);
  }
  int leases_elsewhere = 0;
  std::vector<TakenLease> kept;
  const uint64_t processes = 1 + random.Below(4);
  for (uint64_t process = 1; process <= processes; ++process) {
    Process server(random, runs);
    std::erase_if(kept, [&](const TakenLease&) { return random.Happens(3); });  // lost
    server.KeepLeases(std::move(kept));
    for (uint64_t steps = 20 + random.Below(100); steps > 0; --steps) server.Step();
    if (process == processes) server.Finish();
    kept = server.Stop(random.Happens(2));
    leases_elsewhere += server.leases_elsewhere();
    for (const RandomRun& run : runs) ExpectSamplesCountOnce(*run.journal);
    for (const RandomRun& run : runs) {
      if (process == processes || run.HasEnded()) ExpectRight(run);
    }
    std::erase_if(runs, [](const RandomRun& run) { return run.HasEnded(); });
    if (runs.empty()) break;
  }
  return leases_elsewhere;
}

TEST(RandomSchedules, GiveTheBytesOfOnePlace) {
  const int schedules = IsNightly() ? 400 : 100;
  int leases_elsewhere = 0;
  for (int seed = 1; seed <= schedules; ++seed) {
    SCOPED_TRACE(absl::StrCat("seed ", seed));
    leases_elsewhere += PlaySchedule(static_cast<uint64_t>(seed));
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(leases_elsewhere, 5 * schedules / 2);  // the schedules are worth playing
}

// The same with threads, which no seed can repeat.
TEST(RandomSchedules, GiveTheBytesOfOnePlaceBesideThreads) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(absl::StrCat("seed ", seed));
    Random random(seed);
    FactoryOpener opener(FakeExperiments());
    Scheduler scheduler(opener, 2);
    RemoteExecutor first(scheduler, 5), second(scheduler, 30);
    ThreadExecutor threads(scheduler, 2, random.Happens(2) ? kInfinity : 4);
    threads.Start();
    std::vector<RandomRun> runs(3);
    for (size_t i = 0; i < runs.size(); ++i) {
      RandomRun& run = runs[i];
      run.key = static_cast<int64_t>(i) + 1;
      run.spec = RandomSpec(random);
      run.journal = std::make_shared<RecordingJournal>();
      scheduler.Add(RunOf(run.key, run.spec, run.journal));
    }
    std::vector<Lease> taken;
    for (int step = 0; step < 200; ++step) {
      RemoteExecutor& remote = random.Happens(2) ? first : second;
      if (auto lease = remote.Take()) {
        const bool is_reported = random.Happens(2), is_returned = random.Happens(2);
        if (is_reported) {
          EXPECT_OK(remote.ReportAll(*lease));
        }
        if (is_returned) remote.Return(*lease);
        taken.push_back(*std::move(lease));
      }
      if (step == 100 && random.Happens(3)) {
        runs[0].is_cancelled = true;
        scheduler.Cancel(1);
      }
    }
    for (const Lease& lease : taken) {
      RemoteExecutor& remote = lease.executor == first.number() ? first : second;
      remote.Return(lease);
      if (random.Happens(2)) continue;
      EXPECT_OK(remote.ReportAll(lease));
    }
    for (RandomRun& run : runs) {
      const absl::Status outcome = run.journal->AwaitEnd();
      if (outcome.ok()) run.is_cancelled = false;  // the run ended before
      run.stored.Keep(*run.journal);
      ExpectRight(run);
      ExpectSamplesCountOnce(*run.journal);
    }
    scheduler.Shutdown();
  }
}

}  // namespace
}  // namespace ballpiston::server
