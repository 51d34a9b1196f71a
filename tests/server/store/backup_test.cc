// Checking and copying stores, also while a server writes to them.
#include "server/store/backup.h"

#include <csignal>

#include "server/store/check_store.h"
#include "server/store/job_name.h"
#include "server/store/schema.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

class BackupTest : public testing::Test {
 protected:
  std::string Store() const { return folder_.File("store.sqlite3"); }
  std::string Copy() const { return folder_.File("copy"); }

  // Makes a store with a job that has succeeded and an unfinished job with a checkpoint.
  void MakeStore() {
    Gate gate;
    RunningServer server(
        {.data_dir = folder_.path(),
         .factory = FakeExperiments([&](size_t point, uint64_t block, std::stop_token stop) {
           if (point == 2 && block >= 3) gate.Pass(stop);
         })});
    finished_ = server.Succeeded(Equilibrium(2, 3));
    results_ = server.ResultBytes(finished_);
    unfinished_ = server.Submit(Equilibrium(3, 6));
    gate.AwaitWaiting(2);  // both workers wait: all earlier blocks are done
  }

  std::vector<std::string> Problems() { return CheckStore(Store()).value().problems; }

  TemporaryFolder folder_;
  std::string finished_, unfinished_;
  std::vector<std::string> results_;
};

TEST_F(BackupTest, ASoundStoreIsSummedUpAndCopiedIntoOneFileOfMode0600) {
  MakeStore();
  ASSERT_OK_AND_ASSIGN(const auto summary, CheckStore(Store()));
  EXPECT_TRUE(summary.sound());
  EXPECT_EQ(summary.version, kSchemaVersion);
  EXPECT_EQ(summary.jobs.at("SUCCEEDED"), 1);
  EXPECT_EQ(summary.jobs.at("RUNNING"), 1);
  EXPECT_GE(summary.results, 2);
  EXPECT_THAT(SummaryText(summary), HasSubstr("the store is sound"));
  ASSERT_OK_AND_ASSIGN(const auto copied, BackupStore(Store(), Copy()));
  EXPECT_TRUE(copied.sound());
  EXPECT_EQ(ModeOf(Copy()), 0600u);
  const auto names = NamesIn(folder_.path());
  EXPECT_EQ(std::ranges::count_if(names, [](const auto& n) { return n.starts_with("copy"); }), 1);
  WriteFile(Copy(), "precious");
  EXPECT_THAT(BackupStore(Store(), Copy()), StatusIs(absl::StatusCode::kAlreadyExists));
  EXPECT_EQ(Contents(Copy()), "precious");
  EXPECT_THAT(BackupStore(Store(), Copy() + "/x"), StatusIs(absl::StatusCode::kFailedPrecondition));
}

TEST_F(BackupTest, EachInconsistencyIsReported) {
  MakeStore();
  const std::string finished = *JobIdOf(finished_), unfinished = *JobIdOf(unfinished_);
  const struct {
    const char* sql;
    std::string sentence;
  } damages[] = {
      {"UPDATE jobs SET state = 9 WHERE sequence = 1", "has an unknown state: 9"},
      {"UPDATE jobs SET message = x'ff' WHERE sequence = 1", "cannot be read"},
      {"UPDATE jobs SET grid = x'ff' WHERE sequence = 1", "cannot be read"},
      {"UPDATE jobs SET state = 5 WHERE sequence = 1", "failed without an error"},
      {"UPDATE jobs SET end_time = NULL WHERE sequence = 1", "ended but has no end time"},
      {"UPDATE jobs SET points_done = 1 WHERE sequence = 1", "finished 1 points and has 2 results"},
      {"UPDATE jobs SET points = 3 WHERE sequence = 1", "succeeded with 2 results of 3"},
      {"DELETE FROM results WHERE job = 1 AND point = 1", "finished 2 points and has 1 results"},
      {"UPDATE results SET point = 7 WHERE job = 1 AND point = 1", "a result without a point"},
      {"UPDATE results SET result = x'ff' WHERE job = 1 AND point = 1",
       "the result of job " + finished},
      {"INSERT INTO results VALUES (77, 0, 1, 1, 0, x'', x'', x'')",
       "a result without a point: job 77, point 0"},
      {"UPDATE results SET details = x'ff' WHERE job = 1 AND point = 1",
       "the result of job " + finished + ", point 1"},
      {"UPDATE results SET continuation = x'ff' WHERE job = 1 AND point = 1",
       "the result of job " + finished + ", point 1"},
      {"INSERT INTO checkpoints VALUES (1, 0, x'')",
       "a checkpoint without a point of an active job: job " + finished + ", point 0"},
      {"INSERT OR REPLACE INTO checkpoints VALUES (2, 2, x'ff')",
       "the checkpoint of job " + unfinished + ", point 2"},
      {"INSERT INTO checkpoints VALUES (2, 0, x'')",
       "a checkpoint of a finished point: job " + unfinished + ", point 0"},
  };
  const std::string sound = Contents(Store());
  for (const auto& damage : damages) {
    WriteFile(Store(), sound);
    EXPECT_THAT(Problems(), IsEmpty());
    ChangeStore(Store(), damage.sql);
    EXPECT_THAT(Problems(), Contains(HasSubstr(damage.sentence))) << damage.sql;
  }
}

TEST_F(BackupTest, ADamagedPageIsReported) {
  MakeStore();
  std::string contents = Contents(Store());
  for (size_t at = 5 * 4096; at < contents.size(); ++at) contents[at] = 'x';
  WriteFile(Store(), contents);
  ASSERT_OK_AND_ASSIGN(const auto summary, CheckStore(Store()));
  EXPECT_FALSE(summary.sound());
  EXPECT_THAT(SummaryText(summary), HasSubstr("the store is damaged"));
  EXPECT_THAT(BackupStore(Store(), Copy()), StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_FALSE(std::filesystem::exists(Copy()));
}

TEST_F(BackupTest, ARestoredCopyResumesToTheSameBytes) {
  MakeStore();
  ASSERT_OK(BackupStore(Store(), Copy()));
  const TemporaryFolder elsewhere;
  WriteFile(elsewhere.File("store.sqlite3"), Contents(Copy()));
  RunningServer restored({.data_dir = elsewhere.path()});
  EXPECT_EQ(restored.ResultBytes(finished_), results_);
  EXPECT_EQ(restored.AwaitEnd(unfinished_).state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(restored.ResultBytes(unfinished_),
            restored.ResultBytes(restored.Succeeded(Equilibrium(3, 6))));
}

// As `nohup` sets it.
TEST_F(BackupTest, AnIgnoredSignalStaysIgnored) {
  MakeStore();
  signal(SIGHUP, SIG_IGN);
  EXPECT_OK(BackupStore(Store(), Copy()));
  EXPECT_EQ(signal(SIGHUP, SIG_DFL), SIG_IGN);
}

// The operator forgot to move the old store's log away.
TEST_F(BackupTest, ACopyRestoredBesideAnOldLogIsRefused) {
  MakeStore();
  ASSERT_OK(BackupStore(Store(), Copy()));
  std::string log;
  {
    RunningServer server({.data_dir = folder_.path()});
    server.AwaitEnd(unfinished_);
    log = Contents(Store() + "-wal");
  }
  ASSERT_GT(log.size(), 1000u);
  WriteFile(Store(), Contents(Copy()));
  WriteFile(Store() + "-wal", log);
  EXPECT_THAT(OpenStoreFile(Store()), StatusIs(absl::StatusCode::kFailedPrecondition,
                                               HasSubstr("the log of another store")));
  EXPECT_EQ(Contents(Store() + "-wal"), log);
}

// A server writes and checkpoints without a pause, while copies are made and checked.
TEST_F(BackupTest, CopiesMadeWhileAServerWorksAreSound) {
  RunningServer server({.data_dir = folder_.path()});
  std::atomic<bool> done = false;
  std::thread client([&] {
    while (!done) server.Delete(server.Succeeded(Equilibrium(20, 5)));
  });
  for (int i = 0; i < 10; ++i) {
    EXPECT_OK(BackupStore(Store(), folder_.File("copy-" + std::to_string(i))));
    EXPECT_THAT(Problems(), IsEmpty());
  }
  done = true;
  client.join();
}

}  // namespace
}  // namespace ballpiston::server
