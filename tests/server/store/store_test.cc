#include "server/store/store.h"

#include <new>

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

JobRecord Record(const std::string& id) {
  JobRecord record;
  record.id = id;
  record.question = "question of " + id;
  record.job.mutable_spec()->set_seed(7);
  record.job.mutable_spec()->mutable_grid()->add_rho(0.53);
  record.job.mutable_create_time()->set_nanos(123'456'789);
  record.job.set_principal("ada");
  record.job.set_priority(-3);
  record.job.mutable_progress()->set_points(3);
  return record;
}

class StoreTest : public testing::Test {
 protected:
  std::unique_ptr<Store> Open(Store::Options options = {}) {
    options.stall = kUnreachedLimit;
    auto store = Store::Open(File(), options);
    EXPECT_OK(store);
    return store.ok() ? *std::move(store) : nullptr;
  }
  std::string File() const { return folder_.File("store.sqlite3"); }

  static int64_t Insert(Store& store, JobRecord record) {
    EXPECT_OK(store.Commit([&](Database& database) { InsertJob(database, record); }));
    return record.sequence;
  }

  static std::optional<JobRecord> Find(Store& store, const std::string& id) {
    return ReadFrom(store,
                    [&](Database& database) { return FindJob(database, id, Grid::kIncluded); });
  }

  static std::optional<std::string> Checkpoint(Store& store, int64_t job, int64_t point) {
    return ReadFrom(store,
                    [&](Database& database) { return ReadCheckpoint(database, job, point); });
  }

  TemporaryFolder folder_;
};

TEST_F(StoreTest, AJobIsThereAfterReopening) {
  Insert(*Open(), Record("a"));
  const auto found = Find(*Open(), "a");
  ASSERT_TRUE(found);
  EnsembleJob expected = Record("a").job;
  expected.set_name("ensembleJobs/a");
  expected.set_state(EnsembleJob::QUEUED);
  EXPECT_EQ(found->job.DebugString(), expected.DebugString());
  EXPECT_EQ(found->question, "question of a");
}

// Jobs with different labels can have one question. The search is bounded, because other writes
// wait for it.
TEST_F(StoreTest, AnAnswerIsSearchedAmongTheNewestJobs) {
  const auto store = Open();
  ASSERT_OK(store->Commit([](Database& database) {
    for (int i = 0; i <= kMostAnswers; ++i) {
      JobRecord record = Record(std::to_string(i));
      record.question = "question";
      record.job.set_pinned(i == 7);
      InsertJob(database, record);
      const absl::Time end = absl::FromUnixSeconds(i);
      EndJob(database, record.sequence, {.time = end, .error = {}, .numbers = {}});
    }
  }));
  int asked = 0;
  const auto find = [&](int accepted) {
    return ReadFrom(*store, [&](Database& database) {
      asked = 0;
      return FindAnswer(database, "ada", "question",
                        [&](const EnsembleJob&) { return ++asked == accepted; });
    });
  };
  EXPECT_EQ(find(1)->job.DebugString(), Find(*store, "7")->job.DebugString());
  EXPECT_EQ(find(2)->id, std::to_string(kMostAnswers));
  EXPECT_FALSE(find(kMostAnswers + 1));
  EXPECT_EQ(asked, kMostAnswers);
}

TEST_F(StoreTest, TheReaderCannotWrite) {
  const auto store = Open();
  EXPECT_FALSE(store->Read([](Database& database) { database.Execute("DELETE FROM jobs"); }).ok());
}

// SQLite may make an empty log and an index beside the file.
TEST_F(StoreTest, EveryKindOfWrongFileIsRefusedAndUntouched) {
  ASSERT_OK(Open()->Commit([&](Database& database) {
    for (int i = 0; i < 200; ++i) {
      JobRecord record = Record("job-" + std::to_string(i));
      (*record.job.mutable_labels())["k"] = std::string(300, 's');
      InsertJob(database, record);
    }
  }));
  const std::string sound = Contents(File());
  ASSERT_GT(sound.size(), 50000u);
  const struct {
    const char* why;
    size_t at;
    std::string bytes;  // are written there; without bytes, the file ends there
  } damages[] = {{"damaged", 0, "not a database"},
                 {"damaged", 100, std::string(8, '\x7f')},
                 {"damaged", 40960, std::string(4096, 'x')},
                 {"damaged", 20000, ""},
                 {"damaged", 4096, ""},
                 {"damaged", 10, ""},
                 {"version -1", 60, "\xff\xff\xff\xff"},
                 {"version 0", 60, std::string(4, '\0')},
                 {"newer", 60, std::string("\0\0\1\0", 4)},
                 {"not a ballpiston store", 68, "cake"}};
  for (const auto& [why, at, bytes] : damages) {
    std::string file = sound.substr(0, bytes.empty() ? at : sound.size());
    file.replace(at, bytes.size(), bytes);
    WriteFile(File(), file);
    for (const char* beside : {"-wal", "-shm"}) std::filesystem::remove(File() + beside);
    EXPECT_THAT(Store::Open(File(), {}),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(why)));
    EXPECT_EQ(Contents(File()), file);
    EXPECT_EQ(Contents(File() + "-wal"), "");
  }
}

TEST_F(StoreTest, AFileThatThisUserCannotOpenIsNotPermitted) {
  Open();
  ASSERT_EQ(chmod(File().c_str(), 0), 0);
  ASSERT_EQ(chmod(folder_.path().c_str(), 0777), 0);
  const uid_t user = geteuid();
  // Root can open every file.
  if (user == 0 && seteuid(65534) != 0) GTEST_SKIP() << "root cannot become another user here";
  const absl::Status opened = Store::Open(File(), {}).status();
  ASSERT_EQ(seteuid(user), 0);
  EXPECT_THAT(opened, StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr(File())));
}

// A change that cannot be written, and one that is rejected in the middle.
TEST_F(StoreTest, AnImpossibleWriteIsRejectedAlone) {
  const auto store = Open({.delay = kUnreachedLimit});
  absl::Status full = absl::ResourceExhaustedError("too many jobs");
  full.SetPayload("reason", absl::Cord("TOO_MANY_JOBS"));
  const auto broken = [&](Database& database) {
    database.Execute("INSERT INTO results (job, point, samples) VALUES (1, 1, NULL)");
  };
  const auto rejected = [&](Database& database) {
    JobRecord record = Record("half");
    InsertJob(database, record);
    database.Fail(full);
  };
  absl::Status told;
  store->RecordCheckpoint(1, 0, 0, [] { return "before"; });
  store->Record(broken, [&](const absl::Status& status) { told = status; });
  store->RecordCheckpoint(1, 1, 0, [] { return "after"; });
  EXPECT_THAT(store->Commit(broken), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(told, StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_EQ(store->Commit(rejected), full);
  EXPECT_FALSE(Find(*store, "half"));
  EXPECT_FALSE(store->failing());
  EXPECT_EQ(store->counts().pending_writes, 0);
  EXPECT_EQ(Checkpoint(*store, 1, 0), "before");
  EXPECT_EQ(Checkpoint(*store, 1, 1), "after");
}

TEST_F(StoreTest, AChangeThatRunsOutOfMemoryIsRetried) {
  const auto store =
      Open({.delay = std::chrono::milliseconds(1), .retry = std::chrono::milliseconds(1)});
  int attempts = 0;
  store->RecordCheckpoint(1, 0, 0, [&]() -> std::string {
    if (++attempts < 3) throw std::bad_alloc();
    return "kept";
  });
  AwaitThat([&] { return store->Flush().ok(); });
  EXPECT_EQ(Checkpoint(*store, 1, 0), "kept");
}

TEST_F(StoreTest, TheFirstWriterOfAResultWins) {
  const auto store = Open();
  for (const char* result : {"first", "second"}) {
    store->RecordResult(1, {2, 10, result});
    ASSERT_OK(store->Flush());
  }
  std::vector<std::string> results;
  EXPECT_OK(store->Read([&](Database& database) {
    ReadResults(database, 1, 0, Details::kLeftOut, [&](const PointRow& row) {
      results.push_back(std::to_string(row.point) + row.result);
      return true;
    });
  }));
  EXPECT_THAT(results, ElementsAre("2first"));
}

// Only the last checkpoint of a point is written.
TEST_F(StoreTest, WritesAreCommittedInGroups) {
  const auto store = Open({.delay = kUnreachedLimit});
  for (int i = 0; i < 1000; ++i) {
    store->RecordCheckpoint(1, i / 10, 0, [i] { return std::to_string(i); });
  }
  ASSERT_OK(store->Flush());
  EXPECT_EQ(store->counts().commits, 1);
  EXPECT_EQ(store->counts().checkpoints_written, 100);
  EXPECT_EQ(Checkpoint(*store, 1, 99), "999");
}

// The store's thread finds the checkpoint when it frees the space of the deletion.
TEST_F(StoreTest, ACheckpointWaitsForItsDelayWhileSpaceIsFreed) {
  const auto store = Open({.delay = kUnreachedLimit});
  const auto nothing = [](Database&) {};
  store->Record(nothing,
                [&](const absl::Status&) { store->RecordCheckpoint(1, 0, 0, [] { return "r"; }); });
  ASSERT_OK(store->CommitDeletion(nothing));
  store->AwaitSwept();
  EXPECT_EQ(store->counts().checkpoints_written, 0);
}

TEST_F(StoreTest, CheckpointsOfAFinishedPointAreNeitherWrittenNorKept) {
  const auto store = Open({.delay = kUnreachedLimit});
  store->RecordCheckpoint(1, 0, 0, [] { return "r"; });
  ASSERT_OK(store->Flush());
  EXPECT_EQ(store->counts().checkpoints_written, 1);
  store->RecordCheckpoint(1, 0, 0, [] { return "r"; });
  store->RecordCheckpoint(1, 5, 0, [] { return "other"; });
  store->RecordResult(1, {0, 8, "result"});
  ASSERT_OK(store->Flush());
  EXPECT_EQ(store->counts().checkpoints_written, 2);
  EXPECT_FALSE(Checkpoint(*store, 1, 0));
  EXPECT_EQ(Checkpoint(*store, 1, 5), "other");
}

// The second checkpoint does not fit into the flush's group.
TEST_F(StoreTest, AFlushWritesACheckpointThatALaterOneReplaces) {
  std::promise<void> has_first, is_checked;
  const auto store = Open({.delay = kUnreachedLimit});
  const auto post = [&](const absl::Status&) {
    store->RecordCheckpoint(1, 0, 1, [] { return "first"; });
    has_first.set_value();
    AwaitThat([&] { return store->counts().pending_writes == 2; });  // the checkpoint and the flush
    const auto second = [&]() -> std::string {
      is_checked.get_future().wait();
      return "second";
    };
    store->RecordCheckpoint(1, 0, 2, second, 3 << 20);
  };
  store->RecordSoon([](Database&) {}, post);
  has_first.get_future().wait();
  EXPECT_OK(store->Flush());
  EXPECT_EQ(Checkpoint(*store, 1, 0), "first");
  is_checked.set_value();
}

// Else the next reader would get a connection whose transaction is open.
TEST_F(StoreTest, AReadThatThrowsEndsItsTransaction) {
  const auto store = Open({.readers = 1});
  Insert(*store, Record("a"));
  const auto count = [](Database& database) {
    return database.Integer("SELECT count(*) FROM jobs");
  };
  const auto run_out_of_memory = [](Database&) { throw std::bad_alloc(); };
  EXPECT_THROW(store->Read(run_out_of_memory).IgnoreError(), std::bad_alloc);
  EXPECT_OK(store->Read(count));
}

TEST_F(StoreTest, ARetryIsAwaitedExceptByAShutdown) {
  auto store = Open({.retry = std::chrono::milliseconds(20)});
  const auto start = std::chrono::steady_clock::now();
  store->AwaitRetry();
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(20));
  store = Open({.retry = kUnreachedLimit});
  store->StopWaiting();
  store->AwaitRetry();
}

// The store's thread itself asks, so that nothing can be swept meanwhile.
TEST_F(StoreTest, AShutdownDoesNotWaitForFreeSpace) {
  const auto store = Open({.delay = kUnreachedLimit});
  const auto nothing = [](Database&) {};
  store->Record(nothing, [&](const absl::Status&) {
    store->StopWaiting();
    EXPECT_FALSE(store->AwaitSwept());
  });
  EXPECT_OK(store->CommitDeletion(nothing));
}

// Two groups: each result has more bytes than half a group.
TEST_F(StoreTest, AWriteIsToldWhenItsOwnGroupIsCommitted) {
  const auto store = Open({.delay = kUnreachedLimit});
  const int64_t job = Insert(*store, Record("a"));
  std::vector<int64_t> stored;
  for (int64_t point = 0; point < 2; ++point) {
    PointRow row{point, 1, "result", std::string(size_t{3} << 19, 'd')};
    store->RecordResult(job, std::move(row), [&](int64_t) {
      stored.push_back(
          ReadFrom(*store, [&](Database& database) { return CountResults(database, job); }));
    });
  }
  ASSERT_OK(store->Flush());
  EXPECT_THAT(stored, ElementsAre(1, 2));
}

}  // namespace
}  // namespace ballpiston::server
