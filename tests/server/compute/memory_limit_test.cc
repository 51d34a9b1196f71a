// The points that are computed at a time take no more memory than the limit.
#include "server/compute/scheduler.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr double kLimitBytes = 100;
constexpr uint64_t kAllBlocks = std::numeric_limits<uint64_t>::max();

// A thread at a point takes as many bytes as the seed of its specification.
class SeedsAreBytes : public FactoryOpener {
 public:
  SeedsAreBytes() : FactoryOpener(FakeExperiments()) {}
  double MemoryOf(const EnsembleSpec& spec, size_t, int threads) override {
    return static_cast<double>(spec.seed) * threads;
  }
};

class MemoryLimitTest : public testing::Test {
 protected:
  ~MemoryLimitTest() override { scheduler_.Shutdown(); }

  EnsembleSpec SpecOfBytes(uint64_t bytes) const { return FakeSpec(2, 3000, bytes); }

  JournalPointer Add(int64_t key, uint64_t bytes) {
    auto journal = std::make_shared<RecordingJournal>();
    scheduler_.Add(RunOf(key, SpecOfBytes(bytes), journal));
    bytes_[key] = bytes;
    return journal;
  }

  // The next turn that does not open a point.
  std::optional<Lease> BeginChunks() {
    std::optional<Lease> lease = local_.Begin();
    while (lease && lease->OpensPoints()) {
      local_.End(*lease, 0);
      lease = local_.Begin();
    }
    return lease;
  }

  // Turns that are in progress at the same time, as many as there can be. Returns the runs whose
  // chunks are computed.
  std::multiset<int64_t> TurnsAtOnce(size_t most, uint64_t blocks) {
    std::vector<Lease> leases;
    std::multiset<int64_t> runs;
    double bytes = 0;
    while (leases.size() < most) {
      const auto lease = local_.Begin();
      if (!lease) break;
      leases.push_back(*lease);
      if (lease->OpensPoints()) continue;
      runs.insert(lease->run);
      bytes += static_cast<double>(bytes_.at(lease->run));
    }
    most_bytes_ = std::max(most_bytes_, bytes);
    for (const Lease& lease : leases) local_.End(lease, blocks, 0.1);
    return runs;
  }

  SeedsAreBytes opener_;
  Scheduler scheduler_{opener_, 1, {.memory_limit = kLimitBytes}};
  SteppedExecutor local_{scheduler_};
  std::map<int64_t, uint64_t> bytes_;
  double most_bytes_ = 0;
};

TEST_F(MemoryLimitTest, TheLeasesOfThisServerTakeNoMoreMemoryThanTheLimit) {
  std::vector<JournalPointer> journals;
  const std::vector<uint64_t> bytes = {40, 50, 60, 70};
  for (size_t i = 0; i < bytes.size(); ++i) {
    journals.push_back(Add(static_cast<int64_t>(i) + 1, bytes[i]));
  }
  for (int round = 0; round < 1000 && journals.back()->ends == 0; ++round) TurnsAtOnce(8, 100);
  local_.TakeAllTurns();
  EXPECT_LE(most_bytes_, kLimitBytes);
  EXPECT_GE(most_bytes_, 90);  // the first two fit together
  for (size_t i = 0; i < bytes.size(); ++i) {
    ASSERT_EQ(journals[i]->ends, 1) << bytes[i];
    ExpectAllPointsRight(SpecOfBytes(bytes[i]), *journals[i]);
  }
}

TEST_F(MemoryLimitTest, OnePointAloneMayTakeMore) {
  const auto large = Add(1, 1000);
  local_.TakeAllTurns();
  ASSERT_EQ(large->ends, 1);
  EXPECT_OK(*large->outcome);
}

// The first of them can be computed by one thread only, the second by two.
TEST_F(MemoryLimitTest, FurtherThreadsTakeMemoryToo) {
  for (const auto& [bytes, threads] : {std::pair(60, 1u), std::pair(40, 2u)}) {
    const auto journal = Add(bytes, static_cast<uint64_t>(bytes));
    size_t most = 0;
    while (journal->ends == 0) most = std::max(most, TurnsAtOnce(8, 100).size());
    EXPECT_EQ(most, threads) << bytes;
    EXPECT_OK(*journal->outcome);
  }
  EXPECT_LE(most_bytes_, kLimitBytes);
}

// Two small runs fit together, and a lease of one of them begins before one of the other ends.
TEST_F(MemoryLimitTest, ALargePointGetsItsTurn) {
  constexpr int64_t kLarge = 4;
  const std::vector<JournalPointer> journals = {Add(1, 40), Add(2, 40), Add(3, 40),
                                                Add(kLarge, 70)};
  std::optional<Lease> lease = BeginChunks();
  for (int turn = 0; turn < 8 && lease->run != kLarge; ++turn) {
    std::optional<Lease> next = BeginChunks();
    local_.End(*lease, kAllBlocks, 1);
    lease = next ? next : BeginChunks();
    ASSERT_TRUE(lease);
  }
  EXPECT_EQ(lease->run, kLarge);
  local_.End(*lease, kAllBlocks);
  local_.TakeAllTurns();
  for (const auto& journal : journals) EXPECT_EQ(journal->ends, 1);
}

}  // namespace
}  // namespace ballpiston::server
