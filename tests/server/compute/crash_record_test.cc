#include "server/compute/crash_record.h"

#include "server/fatal_signals.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

constexpr RunName kFirst = {1, 10};
constexpr RunName kSecond = {2, 20};
constexpr RunName kThird = {3, 30};

constexpr int kKilledFromOutside = 0;

// Processes, one after the other, with the record in one folder.
class CrashRecordTest : public testing::Test {
 protected:
  // Points that are being computed. Without a point, the run is being examined.
  using Turns = std::map<RunName, std::set<size_t>>;

  // A process starts, computes, and is killed by the signal while it computes the turns. The file
  // of the record keeps its contents of this moment.
  void LiveAndDie(const Turns& turns, int signal, const OutOfMemoryKills& at_start = {}) {
    CrashRecord record(folder_.path(), at_start);
    std::vector<std::unique_ptr<CrashRecord::Entry>> computing;
    for (const auto& [run, points] : turns) {
      if (points.empty()) computing.push_back(std::make_unique<CrashRecord::Entry>(record, run));
      for (const size_t point : points) {
        computing.push_back(std::make_unique<CrashRecord::Entry>(record, run, point));
      }
    }
    Die(signal);
    while (!computing.empty()) computing.pop_back();  // the innermost first
  }

  void Die(int signal) {
    if (signal != kKilledFromOutside) CrashRecord::NoteDeath(signal);
    at_death_ = Contents(folder_.File("computing"));
  }

  // What the next process finds.
  std::unique_ptr<CrashRecord> Next(const OutOfMemoryKills& now = {}) {
    if (at_death_) WriteFile(folder_.File("computing"), *std::exchange(at_death_, std::nullopt));
    return std::make_unique<CrashRecord>(folder_.path(), now);
  }

  const TemporaryFolder folder_;
  std::optional<std::string> at_death_;  // the record's file
};

TEST_F(CrashRecordTest, TwoDeathsWithDifferentRunsMakeASuspectOfTheCommonOne) {
  LiveAndDie({{kFirst, {0}}, {kSecond, {0}}}, SIGSEGV);
  Next().reset();
  LiveAndDie({{kSecond, {0}}, {kThird, {0}}}, SIGABRT);
  const auto record = Next();
  EXPECT_EQ(record->Deaths(kFirst), 1);
  EXPECT_EQ(record->Deaths(kSecond), kDeathsOfASuspect);
  EXPECT_EQ(record->Deaths(kThird), 1);
  record->KeepOneDeath(kSecond);
  EXPECT_EQ(record->Deaths(kSecond), 1);
}

TEST_F(CrashRecordTest, AKillFromOutsideKeepsThePointsOfTheLastDeath) {
  LiveAndDie({{kFirst, {7}}}, SIGSEGV);
  Next().reset();
  LiveAndDie({{kFirst, {5}}}, kKilledFromOutside);
  EXPECT_EQ(Next()->LastPoints(kFirst), (std::set<size_t>{7}));
  LiveAndDie({{kSecond, {5}}}, SIGSEGV);
  EXPECT_EQ(Next()->LastPoints(kFirst), (std::set<size_t>{7}));
  LiveAndDie({{kFirst, {}}}, SIGSEGV);
  EXPECT_EQ(Next()->Deaths(kFirst), 2);
  EXPECT_EQ(Next()->LastPoints(kFirst), (std::set<size_t>{7}));
  LiveAndDie({{kFirst, {8, 9}}}, SIGSEGV);
  EXPECT_EQ(Next()->Deaths(kFirst), 3);
  EXPECT_EQ(Next()->LastPoints(kFirst), (std::set<size_t>{8, 9}));
}

TEST_F(CrashRecordTest, ADeathInAnExaminationCountsForItsRunAlone) {
  LiveAndDie({{kFirst, {0}}, {kSecond, {}}}, SIGSEGV);
  const auto record = Next();
  EXPECT_EQ(record->Deaths(kFirst), 0);
  EXPECT_EQ(record->Deaths(kSecond), 1);
}

TEST_F(CrashRecordTest, AThreadWithoutRoomInTheRecordWaits) {
  {
    CrashRecord record(folder_.path(), {});
    std::vector<std::unique_ptr<CrashRecord::Entry>> all;
    for (size_t point = 0; point < 2048; ++point) {
      all.push_back(std::make_unique<CrashRecord::Entry>(record, kFirst, point));
    }
    std::atomic<bool> begins = false, has_room = false;
    std::thread examines([&] {
      begins = true;
      const CrashRecord::Entry examining(record, kSecond);
      EXPECT_TRUE(has_room);
      Die(SIGSEGV);
    });
    AwaitThat([&] { return begins.load(); });
    has_room = true;
    all.pop_back();
    examines.join();
    while (!all.empty()) all.pop_back();
  }
  EXPECT_EQ(Next()->Deaths(kFirst), 0);
  EXPECT_EQ(Next()->Deaths(kSecond), 1);
}

TEST_F(CrashRecordTest, AStoredChunkClearsTheRun) {
  LiveAndDie({{kFirst, {0}}, {kSecond, {0}}}, SIGSEGV);
  Next()->Clear(kFirst);
  const auto record = Next();
  EXPECT_EQ(record->Deaths(kFirst), 0);
  EXPECT_EQ(record->Deaths(kSecond), 1);
  record->ClearAllBut({kThird});
  EXPECT_EQ(record->Deaths(kSecond), 0);
}

// Counts of different boots are not compared.
TEST_F(CrashRecordTest, AnOutOfMemoryKillCounts) {
  const OutOfMemoryKills before = {"boot group", 7}, after = {"boot group", 8};
  LiveAndDie({{kFirst, {0}}}, kKilledFromOutside, before);
  EXPECT_EQ(Next({"other boot group", 8})->Deaths(kFirst), 0);
  LiveAndDie({{kFirst, {0}}}, kKilledFromOutside, {});
  EXPECT_EQ(Next({})->Deaths(kFirst), 0);
  LiveAndDie({{kFirst, {0}}}, kKilledFromOutside, before);
  EXPECT_EQ(Next(after)->Deaths(kFirst), 1);
  EXPECT_EQ(Next(after)->Deaths(kFirst), 1);
}

TEST_F(CrashRecordTest, AnOutOfMemoryKillThatSystemdReportsCountsOnce) {
  LiveAndDie({{kFirst, {0}}}, kKilledFromOutside);
  WriteFile(folder_.File(kOutOfMemoryFile), "");
  EXPECT_EQ(Next()->Deaths(kFirst), 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.File(kOutOfMemoryFile)));
  EXPECT_EQ(Next()->Deaths(kFirst), 1);
}

// Another run has the key: the store was restored from a backup, or a newer engine computes again.
TEST_F(CrashRecordTest, AnotherGenerationOfARunIsAnotherRun) {
  LiveAndDie({{kFirst, {0}}}, SIGSEGV);
  EXPECT_EQ(Next()->Deaths({kFirst.run, kFirst.generation + 1}), 0);
}

TEST_F(CrashRecordTest, AFileOfAnotherFormatIsReplaced) {
  WriteFile(folder_.File("computing"), std::string(100'000, 'x'));
  EXPECT_EQ(Next()->Deaths(kFirst), 0);
  LiveAndDie({{kFirst, {0}}}, SIGSEGV);
  EXPECT_EQ(Next()->Deaths(kFirst), 1);
}

// ---- real signals: each death is that of a process of its own ----

int Overflow(int depth) {
  volatile char frame[4096];
  frame[0] = static_cast<char>(depth);
  return depth == 0 ? frame[0] : Overflow(depth + 1) + frame[0];
}

class FatalSignalsDeathTest : public testing::Test {
 protected:
  void DieInATurn(const std::function<void()>& fault) {
    const rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    NoteFatalSignals(CrashRecord::NoteDeath);
    CrashRecord record(folder_.path(), {});
    std::thread([&] {
      const CrashRecord::Entry computing(record, kFirst, 0);
      fault();
    }).join();
  }

  // Expects that the next process finds so many deaths. A test calls this function once, because
  // the process that dies runs the test from its beginning, in an empty folder.
  void ExpectDeaths(const std::function<void()>& fault, int deaths) {
    EXPECT_DEATH(DieInATurn(fault), "");
    EXPECT_EQ(CrashRecord(folder_.path(), {}).Deaths(kFirst), deaths);
  }

 private:
  const DeathTestFolder folder_;
};

TEST_F(FatalSignalsDeathTest, AStackOverflowCounts) {
  ExpectDeaths([] { Overflow(1); }, 1);
}
TEST_F(FatalSignalsDeathTest, AnAbortCounts) { ExpectDeaths(abort, 1); }
TEST_F(FatalSignalsDeathTest, AKillIsIgnored) {
  ExpectDeaths([] { raise(SIGKILL); }, 0);
}
TEST_F(FatalSignalsDeathTest, ASignalFromAnotherProcessIsIgnored) {
  ExpectDeaths(
      [] {
        std::system(absl::StrCat("kill -SEGV ", getpid()).c_str());
        pause();
      },
      0);
}

}  // namespace
}  // namespace ballpiston::server
