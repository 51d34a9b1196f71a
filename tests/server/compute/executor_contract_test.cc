// The contract of executor.h, for every kind of executor.
//
// An executor enters the contract with a driver and a row of kExecutors. The contract waits for the
// executor only through its driver.
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
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
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

// How the completions of chunks come to the scheduler.
enum class Delivery { kInOrder, kOutOfOrder, kTwice, kLate, kNever };

std::string NameOf(Delivery delivery) {
  switch (delivery) {
    case Delivery::kInOrder:
      return "InOrder";
    case Delivery::kOutOfOrder:
      return "OutOfOrder";
    case Delivery::kTwice:
      return "Twice";
    case Delivery::kLate:
      return "Late";
    case Delivery::kNever:
      return "Never";
  }
  return "";
}

class ExecutorDriver {
 public:
  virtual ~ExecutorDriver() = default;

  // Lets the executor work until the run has ended. The outcome of the run.
  virtual absl::Status AwaitEnd(RecordingJournal& journal) = 0;

  // Lets the executor work until it has an unfinished lease. The gate is closed and holds up every
  // block from block 1 on.
  virtual void AwaitLease(Gate& gate) = 0;

  // What the executor would do next, and whatever comes to it late. Called after the shutdown.
  virtual void WorkOn() = 0;
};

// ---- threads ----

class ThreadDriver : public ExecutorDriver {
 public:
  // Threads report out of order if several leases are in progress, so these are short then.
  ThreadDriver(Scheduler& scheduler, Delivery delivery)
      : threads_(scheduler, kThreads,
                 delivery == Delivery::kOutOfOrder ? 1 : std::numeric_limits<double>::infinity()) {
    threads_.Start();
  }

  absl::Status AwaitEnd(RecordingJournal& journal) override { return journal.AwaitEnd(); }
  void AwaitLease(Gate& gate) override { gate.AwaitWaiting(kThreads); }
  void WorkOn() override { threads_.Wake(); }

 private:
  static constexpr int kThreads = 4;

  ThreadExecutor threads_;
};

// ---- an executor elsewhere ----

// A local executor opens the points and computes what is too small for an executor elsewhere.
class RemoteDriver : public ExecutorDriver {
 public:
  RemoteDriver(Scheduler& scheduler, Delivery delivery)
      : delivery_(delivery), local_(scheduler, kShortLease), remote_(scheduler) {}

  absl::Status AwaitEnd(RecordingJournal& journal) override {
    while (!journal.outcome) {
      if (WorkElsewhere() || local_.TakeTurn()) continue;
      return absl::InternalError("the run has not ended, but nobody has work");
    }
    return *journal.outcome;
  }

  void AwaitLease(Gate&) override {
    ASSERT_TRUE(local_.TakeTurn());   // opens points
    ASSERT_TRUE(local_.TakeTurn(1));  // computes block 0
    kept_ = remote_.Take();
    ASSERT_TRUE(kept_);
  }

  void WorkOn() override {
    ASSERT_TRUE(kept_);
    EXPECT_TRUE(remote_.is_shut_down());
    EXPECT_OK(remote_.Report(*kept_, {}));
    remote_.Return(*kept_);
    EXPECT_FALSE(remote_.Take());
  }

 private:
  // One lease; false if there is none.
  bool WorkElsewhere() {
    const std::optional<Lease> lease = remote_.Take();
    if (!lease) return false;
    try {
      Deliver(*lease, ComputedChunks(*lease));
    } catch (const std::exception& error) {
      remote_.Fail(*lease, absl::InternalError(error.what()));
    }
    return true;
  }

  void Deliver(const Lease& lease, std::vector<ChunkResult> chunks) {
    switch (delivery_) {
      case Delivery::kInOrder:
        break;
      case Delivery::kOutOfOrder:
        return DeliverWithPredecessor(lease, std::move(chunks));
      case Delivery::kTwice:
        EXPECT_OK(remote_.Report(lease, chunks));
        break;
      case Delivery::kLate:
        remote_.Return(lease);
        break;
      case Delivery::kNever:
        return remote_.Return(lease);
    }
    EXPECT_OK(remote_.Report(lease, std::move(chunks)));
    remote_.Return(lease);
  }

  // Leases in pairs, the second one first, and each in reverse order.
  void DeliverWithPredecessor(const Lease& lease, std::vector<ChunkResult> chunks) {
    const std::optional<Lease> second = remote_.Take();
    if (second) {
      EXPECT_OK(remote_.ReportAll(*second));
      remote_.Return(*second);
    }
    for (auto chunk = chunks.rbegin(); chunk != chunks.rend(); ++chunk) {
      EXPECT_OK(remote_.Report(lease, {*chunk}));
    }
    remote_.Return(lease);
  }

  static constexpr double kShortLease = 0;  // of one chunk

  const Delivery delivery_;
  SteppedExecutor local_;
  RemoteExecutor remote_;
  std::optional<Lease> kept_;
};

// ---- the contract ----

struct ExecutorRow {
  std::string name;
  std::function<std::unique_ptr<ExecutorDriver>(Scheduler&, Delivery)> create;
  std::vector<Delivery> deliveries;  // that the driver can bring about; kInOrder is one
};

void PrintTo(const ExecutorRow& row, std::ostream* out) { *out << row.name; }

template <typename Driver>
ExecutorRow Row(std::string name, std::vector<Delivery> deliveries) {
  return {std::move(name),
          [](Scheduler& scheduler, Delivery delivery) -> std::unique_ptr<ExecutorDriver> {
            return std::make_unique<Driver>(scheduler, delivery);
          },
          std::move(deliveries)};
}

std::vector<ExecutorRow> Executors() {
  return {Row<ThreadDriver>("Threads", {Delivery::kInOrder, Delivery::kOutOfOrder}),
          Row<RemoteDriver>("Remote", {Delivery::kInOrder, Delivery::kOutOfOrder, Delivery::kTwice,
                                       Delivery::kLate, Delivery::kNever})};
}

// Large enough for an executor elsewhere: 4 x 60 s, in chunks of 1 s to 40 s.
EnsembleSpec LargeSpec(uint64_t seed = 1) { return FakeSpec(4, 1500, seed); }

// What a scheduler and its executor need. Counts blocks.
class World {
 public:
  World(const ExecutorRow& row, Delivery delivery, BeforeBlockOfSeed before_block = nullptr)
      : opener_(FakeExperimentsBySeed(
            [this, before_block = std::move(before_block)](uint64_t seed, size_t point,
                                                           uint64_t block, std::stop_token stop) {
              ++blocks_;
              if (before_block) before_block(seed, point, block, stop);
            })),
        scheduler_(opener_, 1),
        driver_(row.create(scheduler_, delivery)) {}
  ~World() { scheduler_.Shutdown(); }

  Scheduler& scheduler() { return scheduler_; }
  ExecutorDriver& driver() { return *driver_; }
  int64_t blocks() const { return blocks_; }

  JournalPointer Add(int64_t key, const EnsembleSpec& spec) {
    auto journal = std::make_shared<RecordingJournal>();
    scheduler_.Add(RunOf(key, spec, journal));
    return journal;
  }

 private:
  std::atomic<int64_t> blocks_ = 0;
  FactoryOpener opener_;
  Scheduler scheduler_;
  std::unique_ptr<ExecutorDriver> driver_;
};

class ExecutorContract : public testing::TestWithParam<ExecutorRow> {};

TEST_P(ExecutorContract, EveryDeliveryGivesTheSameBytes) {
  for (const Delivery delivery : GetParam().deliveries) {
    SCOPED_TRACE(NameOf(delivery));
    World world(GetParam(), delivery);
    const auto first = world.Add(1, LargeSpec(1));
    const auto second = world.Add(2, LargeSpec(2));
    EXPECT_OK(world.driver().AwaitEnd(*first));
    EXPECT_OK(world.driver().AwaitEnd(*second));
    ExpectAllPointsRight(LargeSpec(1), *first);
    ExpectAllPointsRight(LargeSpec(2), *second);
  }
}

TEST_P(ExecutorContract, EveryDeliveryCountsASampleOnce) {
  for (const Delivery delivery : GetParam().deliveries) {
    SCOPED_TRACE(NameOf(delivery));
    World world(GetParam(), delivery);
    const auto journal = world.Add(1, LargeSpec());
    EXPECT_OK(world.driver().AwaitEnd(*journal));
    for (const auto& [point, samples] : journal->merged) {
      EXPECT_EQ(samples, 1500 * kFakeSamplesPerBlock) << "point " << point;
    }
  }
}

// So no lease is dropped, and none is computed twice.
TEST_P(ExecutorContract, EveryLeaseIsReportedIfNothingIsLost) {
  World world(GetParam(), Delivery::kInOrder);
  const auto journal = world.Add(1, LargeSpec());
  EXPECT_OK(world.driver().AwaitEnd(*journal));
  EXPECT_EQ(world.blocks(), 4 * 1500);
}

TEST_P(ExecutorContract, AStoppedRunEnds) {
  Gate gate;
  World world(GetParam(), Delivery::kInOrder,
              [&](uint64_t seed, size_t, uint64_t block, std::stop_token stop) {
                if (seed == 1 && block > 0) gate.Pass(stop);
              });
  const auto stopped = world.Add(1, LargeSpec(1));
  world.driver().AwaitLease(gate);
  world.scheduler().Cancel(1);
  EXPECT_THAT(world.driver().AwaitEnd(*stopped), StatusIs(absl::StatusCode::kCancelled));
  const auto next = world.Add(2, LargeSpec(2));
  EXPECT_OK(world.driver().AwaitEnd(*next));
  ExpectAllPointsRight(LargeSpec(2), *next);
}

TEST_P(ExecutorContract, AnExceptionEndsItsRunOnly) {
  World world(GetParam(), Delivery::kInOrder,
              [](uint64_t seed, size_t, uint64_t block, std::stop_token) {
                if (seed == 13 && block == 700) throw std::runtime_error("the ball left the cell");
              });
  const auto bad = world.Add(1, LargeSpec(13));
  const auto good = world.Add(2, LargeSpec(14));
  EXPECT_THAT(world.driver().AwaitEnd(*bad),
              StatusIs(absl::StatusCode::kInternal, HasSubstr("the ball left the cell")));
  EXPECT_OK(world.driver().AwaitEnd(*good));
  ExpectAllPointsRight(LargeSpec(14), *good);
}

// What a journal and the experiments have been told.
std::string ToldSoFar(RecordingJournal& journal, const World& world) {
  std::lock_guard lock(journal.mutex);
  return absl::StrCat(journal.changes, " merges, ", journal.checkpoints.size(), " checkpoints, ",
                      journal.early.size(), " early chunks, ", journal.finished.size(), " points, ",
                      journal.ends, " ends, ", journal.work, " s, ", world.blocks(), " blocks");
}

TEST_P(ExecutorContract, NothingIsCalledAfterTheShutdown) {
  Gate gate;
  World world(GetParam(), Delivery::kInOrder,
              [&](uint64_t, size_t, uint64_t block, std::stop_token stop) {
                if (block > 0) gate.Pass(stop);
              });
  const auto journal = world.Add(1, LargeSpec());
  world.driver().AwaitLease(gate);
  world.scheduler().Shutdown();
  const std::string told = ToldSoFar(*journal, world);
  gate.Open();
  world.driver().WorkOn();
  world.scheduler().Cancel(1);
  EXPECT_EQ(ToldSoFar(*journal, world), told);
  EXPECT_EQ(journal->ends, 0);
}

// The results of the first process are the checkpoints of the second.
TEST_P(ExecutorContract, ALaterProcessGivesTheSameBytes) {
  std::map<size_t, FoldState> checkpoints;
  {
    Gate gate;
    World world(GetParam(), Delivery::kInOrder,
                [&](uint64_t, size_t, uint64_t block, std::stop_token stop) {
                  if (block > 0) gate.Pass(stop);
                });
    const auto journal = world.Add(1, LargeSpec());
    world.driver().AwaitLease(gate);
    world.scheduler().Shutdown();
    EXPECT_TRUE(journal->finished.empty());
    EXPECT_FALSE(journal->checkpoints.empty());
    checkpoints = journal->checkpoints;
  }
  World world(GetParam(), Delivery::kInOrder);
  const auto journal = std::make_shared<RecordingJournal>();
  journal->stored = checkpoints;
  world.scheduler().Add(RunOf(1, LargeSpec(), journal));
  EXPECT_OK(world.driver().AwaitEnd(*journal));
  ExpectAllPointsRight(LargeSpec(), *journal);
}

INSTANTIATE_TEST_SUITE_P(All, ExecutorContract, testing::ValuesIn(Executors()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace ballpiston::server
