// The points that are computed at a time take no more memory than the limit.
#include "tests/server/compute/stepped_scheduler.h"
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

class MemoryLimitTest : public SchedulerTest {
 protected:
  MemoryLimitTest()
      : SchedulerTest(std::make_unique<SeedsAreBytes>(), {.memory_limit = kLimitBytes}) {}

  static EnsembleSpec SpecOfBytes(int64_t bytes) {
    return FakeSpec(2, 3000, static_cast<uint64_t>(bytes));
  }
  // A run whose key is the number of its bytes. By default its principal has no other.
  JournalPointer AddRun(int64_t bytes, const std::string& principal = "", int32_t priority = 0) {
    return Add(bytes, SpecOfBytes(bytes), [&](RunRequest& request, RecordingJournal&) {
      request.principal = principal.empty() ? std::to_string(bytes) : principal;
      request.priority = priority;
    });
  }

  // The next turn that does not open a point. To open one takes a second, so that runs take turns.
  std::optional<Lease> BeginChunks() {
    std::optional<Lease> lease = Begin();
    while (lease && lease->OpensPoints()) {
      End(*lease, 0, 1);
      lease = Begin();
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
      const auto lease = Begin();
      if (!lease) break;
      leases.push_back(*lease);
      if (lease->OpensPoints()) continue;
      runs.insert(lease->run);
      bytes += static_cast<double>(lease->run);
    }
    most_bytes_ = std::max(most_bytes_, bytes);
    for (const Lease& lease : leases) End(lease, blocks, 0.1);
    return runs;
  }

  double most_bytes_ = 0;
};

TEST_F(MemoryLimitTest, TheLeasesOfThisServerTakeNoMoreMemoryThanTheLimit) {
  std::map<int64_t, JournalPointer> journals;
  for (const int64_t bytes : {40, 50, 60, 70}) journals[bytes] = AddRun(bytes);
  for (int round = 0; round < 1000 && journals[70]->ends == 0; ++round) TurnsAtOnce(8, 100);
  TakeAllTurns();
  EXPECT_LE(most_bytes_, kLimitBytes);
  EXPECT_GE(most_bytes_, 90);  // the first two fit together
  for (const auto& [bytes, journal] : journals) ExpectComplete(SpecOfBytes(bytes), *journal);
}

TEST_F(MemoryLimitTest, OnePointAloneMayTakeMore) {
  const auto large = AddRun(1000);
  TakeAllTurns();
  ExpectComplete(SpecOfBytes(1000), *large);
}

// The first of them can be computed by one thread only, the second by two.
TEST_F(MemoryLimitTest, FurtherThreadsTakeMemoryToo) {
  for (const auto& [bytes, threads] : {std::pair(60, 1u), std::pair(40, 2u)}) {
    const auto journal = AddRun(bytes);
    size_t most = 0;
    while (journal->ends == 0) most = std::max(most, TurnsAtOnce(8, 100).size());
    EXPECT_EQ(most, threads) << bytes;
    EXPECT_OK(*journal->outcome);
  }
  EXPECT_LE(most_bytes_, kLimitBytes);
}

// Two small runs fit together, and a lease of one of them begins before one of the other ends.
TEST_F(MemoryLimitTest, ALargePointGetsItsTurn) {
  constexpr int64_t kLarge = 70;
  const std::vector<JournalPointer> journals = {AddRun(38), AddRun(39), AddRun(40), AddRun(kLarge)};
  std::optional<Lease> lease = BeginChunks();
  for (int turn = 0; turn < 8 && lease->run != kLarge; ++turn) {
    std::optional<Lease> next = BeginChunks();
    End(*lease, kAllBlocks, 1);
    lease = next ? next : BeginChunks();
    ASSERT_TRUE(lease);
  }
  EXPECT_EQ(lease->run, kLarge);
  End(*lease, kAllBlocks);
  TakeAllTurns();
  for (const auto& journal : journals) EXPECT_EQ(journal->ends, 1);
}

// Three points of a principal would fit.
TEST_F(MemoryLimitTest, APrincipalLeavesMemoryToTheOthers) {
  std::vector<Lease> leases;
  const auto begin_all = [&] {
    std::vector<int64_t> runs;
    while (const auto lease = BeginChunks()) {
      leases.push_back(*lease);
      runs.push_back(lease->run);
    }
    return runs;
  };
  for (const int64_t bytes : {30, 31, 32}) AddRun(bytes, "ann");
  EXPECT_EQ(begin_all().size(), 2u);
  AddRun(12, "ann", 1);
  EXPECT_THAT(begin_all(), ElementsAre(12));
  AddRun(10, "bob");
  EXPECT_THAT(begin_all(), ElementsAre(10, 10));  // two threads
  for (const Lease& lease : leases) End(lease, 0);
}

// Points of 520 MB, of which some 500 MB stay while they wait. When the remote executor finds no
// work, 32 points are opened ahead, or as many as the memory permits.
TEST(MemoryLimit, PointsAreOpenedAheadForARemoteExecutorWithinTheLimit) {
  for (const auto& [limit, ahead] : {std::pair(kInfinity, 32u), {4e9, 7u}}) {
    SteppedScheduler stepped(std::make_unique<SeedsAreBytes>(), {.memory_limit = limit});
    EnsembleSpec spec = SixChunks(100);
    spec.seed = 520'000'000;
    stepped.Opened(1, spec);
    EXPECT_EQ(stepped.TakeAllElsewhere(1000).size(), 1u);
    ASSERT_TRUE(stepped.TakeTurn());
    EXPECT_EQ(stepped.TakeAllElsewhere(1000).size(), ahead);
  }
}

}  // namespace
}  // namespace ballpiston::server
