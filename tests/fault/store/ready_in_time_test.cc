// How long a server takes to be ready with a large store. Measured in the long form only, where the
// machine is this test's own.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "server/book/job_book.h"
#include "server/convert/fold_record.h"
#include "server/convert/spec.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"
#include "server/store/store.h"
#include "tests/fault/store/service_on_disk.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/spec_message.h"
#include "tests/server/thread_pool.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

constexpr int kEndedJobs = 100'000;
constexpr int kUnfinishedJobs = 10'000;
constexpr double kPermittedSeconds = 2;

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

JobRecord NewJob(int number) {
  JobRecord record;
  record.id = absl::StrCat("job-", number);
  record.principal = LocalPrincipal().name;
  record.spec = SpecBytes(Equilibrium(1, 2, static_cast<uint64_t>(number)));
  record.question = absl::StrCat("question-", number);
  record.engine_version = EngineVersion();
  record.points = 1;
  return record;
}

void AddEnded(Database& database, int number, const std::string& details) {
  JobRecord record = NewJob(number);
  InsertJob(database, record);
  InsertResult(database, record.sequence, {0, 8, "", details});
  EndJob(database, record.sequence,
         {v1::EnsembleJob::SUCCEEDED, absl::UnixEpoch(), "", {1, 8, 0.1}});
}

void AddUnfinished(Database& database, int number, JobState state, const std::string& engine) {
  JobRecord record = NewJob(number);
  record.state = state;
  record.engine_version = engine;
  InsertJob(database, record);
}

// Fills a store in one commit, and closes it.
void Fill(const std::string& path, const Store::Change& change) {
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(path, {.stall = kNever}));
  ASSERT_OK(store->Commit(change));
}

// The time from the start of a server to its first answer.
double SecondsUntilReady(const std::string& path) {
  const auto start = std::chrono::steady_clock::now();
  const auto store = Store::Open(path, {});
  const double opened = SecondsSince(start);
  EXPECT_OK(store);
  // Jobs wait, so that their computation is not measured.
  ThreadPool pool(2, FakeExperiments([](size_t, uint64_t, const std::stop_token& stop) {
                    Turnstile().Pass(stop);
                  }));
  JobBook book(**store, Limits(), pool.scheduler());
  EXPECT_OK(book.Resume());
  const double resumed = SecondsSince(start);
  EXPECT_OK(book.List(LocalPrincipal(), {.before = std::numeric_limits<int64_t>::max(),
                                         .max_jobs = 50,
                                         .max_bytes = std::numeric_limits<size_t>::max()}));
  const double ready = SecondsSince(start);
  std::cout << testing::UnitTest::GetInstance()->current_test_info()->name() << ": opened after "
            << opened << " s, resumed after " << resumed << " s, listed after " << ready << " s\n";
  return ready;
}

class ReadyInTime : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("BALLPISTON_TORTURE") == nullptr) GTEST_SKIP() << "measures time";
  }
  std::string File() const { return folder_.File("store.sqlite3"); }

  TemporaryFolder folder_;
};

TEST_F(ReadyInTime, WithAHundredThousandEndedJobs) {
  const std::string result = LargeDetails(200);
  Fill(File(), [&](Database& database) {
    for (int i = 0; i < kEndedJobs; ++i) AddEnded(database, i, result);
  });
  std::cout << std::filesystem::file_size(File()) / 1'000'000 << " MB, ";
  EXPECT_LT(SecondsUntilReady(File()), kPermittedSeconds);
}

void ExpectReadyWithUnfinished(const std::string& path, JobState state, const std::string& engine) {
  Fill(path, [&](Database& database) {
    for (int i = 0; i < kUnfinishedJobs; ++i) AddUnfinished(database, i, state, engine);
  });
  EXPECT_LT(SecondsUntilReady(path), kPermittedSeconds);
}

TEST_F(ReadyInTime, WithTenThousandUnfinishedJobs) {
  ExpectReadyWithUnfinished(File(), v1::EnsembleJob::QUEUED, EngineVersion());
}

TEST_F(ReadyInTime, WithTenThousandJobsThatWereBeingCancelled) {
  ExpectReadyWithUnfinished(File(), v1::EnsembleJob::CANCELLING, EngineVersion());
}

TEST_F(ReadyInTime, WithTenThousandJobsOfAnotherEngine) {
  ExpectReadyWithUnfinished(File(), v1::EnsembleJob::QUEUED, "0.1");
}

// A million blocks' worth: 200 points of one job, each with a checkpoint and with chunks that
// arrived before an earlier one. Get answers at once while the points are opened.
TEST_F(ReadyInTime, WithAMillionBlocksOfUnfinishedWork) {
  constexpr int kPoints = 200;
  constexpr uint64_t kEarly = 150;  // chunks a point; a chunk has 32 blocks or more
  EnsembleSpec spec = FakeSpec(kPoints, 0);
  spec.target = {.collisions = int64_t{1} << 40};
  const std::string checkpoint = FoldRecordBytes(FakeState(spec, 0, 32));
  BlockResult merged = FakeMerged(spec, 0, 1);
  Fill(File(), [&](Database& database) {
    JobRecord record = NewJob(0);
    record.engine_version = EngineVersion();
    record.points = kPoints;
    record.spec = SpecBytes(SpecMessage(spec));
    InsertJob(database, record);
    for (int64_t point = 0; point < kPoints; ++point) {
      WriteCheckpoint(database, record.sequence, point, 1, checkpoint);
      for (uint64_t chunk = 3; chunk < 3 + kEarly; ++chunk) {
        InsertChunk(database, record.sequence, point, static_cast<int64_t>(chunk),
                    ChunkRecordBytes({chunk, merged}));
      }
    }
  });
  EXPECT_LT(SecondsUntilReady(File()), kPermittedSeconds);
}

}  // namespace
}  // namespace ballpiston::server
