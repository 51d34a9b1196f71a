// The store on a disk that rejects writes or is full, and after a power cut while it is created.
// The simulation (tests/simulation) fails the disk at random; these tests show what it cannot:
// which write goes first when not all fit.

#include "server/store/backup.h"
#include "server/store/job_table.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/fault/store/power_cut.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using Refusal = FaultDisk::Refusal;

constexpr int64_t kJob = 99;

class DiskFailure : public testing::Test {
 protected:
  std::unique_ptr<Store> Open(Store::Options options = {}) const {
    options.stall = kUnreachedLimit;
    options.retry = std::chrono::milliseconds(1);
    auto store = Store::Open(kStorePath, options);
    EXPECT_OK(store);
    return *std::move(store);
  }

  static void RecordResult(Store& store, int64_t point, size_t bytes) {
    store.RecordResult(kJob, {.point = point, .samples = 1, .result = std::string(bytes, 'x')});
  }

  // 2 MB of results.
  static void RecordLargeJob(Store& store, int64_t job) {
    for (int64_t point = 0; point < 100; ++point) {
      store.RecordResult(job, {.point = point, .result = "x", .details = std::string(20'000, 'x')});
    }
  }

  // A flush succeeds only when all pending writes are written.
  static void AwaitWritten(Store& store) {
    AwaitThat([&] { return store.Flush().ok(); });
  }

  void LeaveRoomFor(int64_t bytes) { disk_.SetCapacity(disk_.bytes_used() + bytes); }

  FaultDisk disk_;
};

TEST_F(DiskFailure, ADiskErrorAtTheStartIsNotReportedAsDamage) {
  for (const Refusal refusal : {Refusal::kFull, Refusal::kWriteError, Refusal::kSyncError}) {
    FaultDisk disk;
    disk.Refuse(refusal);
    EXPECT_THAT(Store::Open(kStorePath, {}),
                StatusIs(absl::StatusCode::kUnavailable,
                         testing::AllOf(HasSubstr("it is unchanged"), Not(HasSubstr("move it")))));
    disk.StopRefusing();
    EXPECT_OK(Store::Open(kStorePath, {}));
  }
}

TEST_F(DiskFailure, AServerStartsOnADiskThatItsReserveFills) {
  constexpr size_t kReserve = 4'000'000;
  const std::string reserve = std::string(kStorePath) + "-reserve";
  FaultDisk disk(DiskFiles{{reserve, std::string(kReserve, 'r')}});
  disk.SetCapacity(kReserve);
  EXPECT_OK(Store::Open(kStorePath, {}));
}

TEST_F(DiskFailure, ABackupThatASignalEndsLeavesNoFile) {
  Open();  // makes the store
  const DeathTestFolder folder;
  disk_.SetBeforeOperation([&] {
    if (!NamesIn(folder.path()).empty()) raise(SIGTERM);
  });
  EXPECT_EXIT(BackupStore(kStorePath, folder.path() + "/copy").IgnoreError(),
              testing::ExitedWithCode(128 + SIGTERM), "");
  EXPECT_THAT(NamesIn(folder.path()), testing::IsEmpty());
}

// Another program makes the file while the store is being copied.
TEST_F(DiskFailure, ABackupDoesNotReplaceAFile) {
  Open();  // makes the store
  const TemporaryFolder folder;
  disk_.SetBeforeOperation([&] { WriteFile(folder.File("copy"), "precious"); });
  EXPECT_THAT(BackupStore(kStorePath, folder.File("copy")),
              StatusIs(absl::StatusCode::kAlreadyExists));
  EXPECT_EQ(Contents(folder.File("copy")), "precious");
  EXPECT_EQ(NamesIn(folder.path()).size(), 1u);
}

// The request is refused because of a result in its group. The result does not fit on the disk, so
// the request runs again without it.
TEST_F(DiskFailure, ARefusalIsNotToldIfItsGroupFails) {
  const auto store = Open({.delay = kUnreachedLimit, .reserve_bytes = 0});
  LeaveRoomFor(100'000);
  RecordResult(*store, 0, 400'000);
  const auto refuse_if_there = [](Database& database) {
    if (CountResults(database, kJob) > 0) database.Fail(absl::AlreadyExistsError("a result"));
  };
  EXPECT_OK(store->Commit(refuse_if_there));
  disk_.StopRefusing();
  AwaitWritten(*store);
  EXPECT_THAT(store->Commit(refuse_if_there), StatusIs(absl::StatusCode::kAlreadyExists));
}

// The file has no room for the second job's log, so that not even a deletion has room in the log.
TEST_F(DiskFailure, OnAFullDiskTheReserveLetsALargeJobBeDeleted) {
  const auto store = Open({.reserve_bytes = 4'000'000});
  RecordLargeJob(*store, 7);
  AwaitWritten(*store);
  LeaveRoomFor(200'000);
  RecordLargeJob(*store, 8);
  AwaitThat([&] { return store->failing(); });
  ASSERT_OK(store->CommitDeletion([](Database& database) { DeleteJob(database, 7); }));
  AwaitWritten(*store);
  EXPECT_EQ(*store->Read([](Database& database) { return CountResults(database, 8); }), 100);
}

// Results that do not fit wait, and do not delay requests, which may free space.
TEST_F(DiskFailure, OnAFullDiskRequestsGoBeforeRecordsThatDoNotFit) {
  const auto store = Open({.delay = kUnreachedLimit, .reserve_bytes = 0});
  LeaveRoomFor(100'000);
  RecordResult(*store, 0, 400'000);
  EXPECT_FALSE(store->Flush().ok());
  EXPECT_OK(store->Commit([](Database& database) { InsertChunk(database, 9, 0, 0, "x"); }));
  EXPECT_TRUE(store->failing());
  EXPECT_EQ(store->counts().pending_writes, 1);
  disk_.StopRefusing();
  AwaitWritten(*store);
  EXPECT_EQ(store->counts().pending_writes, 0);
}

// A request does not fit while the space of a deleted job is being freed. A record that comes
// during this failure waits until the space is free, and a flush does not promise it before.
TEST_F(DiskFailure, OnAFullDiskAFlushFailsWhileARecordWaitsForFreedSpace) {
  const auto store = Open({.reserve_bytes = 0});
  RecordLargeJob(*store, 7);
  AwaitWritten(*store);
  LeaveRoomFor(200'000);
  std::promise<void> flushed;
  const std::shared_future<void> has_flushed = flushed.get_future().share();
  std::thread request, flush;
  const auto change = [&](Database& database) {
    if (store->failing() && !flush.joinable()) {  // the second attempt, alone
      store->Record([&](Database&) { has_flushed.wait(); });
      flush = std::thread([&] {
        EXPECT_THAT(store->Flush(), StatusIs(absl::StatusCode::kUnavailable, HasSubstr("full")));
        flushed.set_value();
      });
      AwaitThat([&] { return store->counts().pending_writes == 4; });  // with a step of the sweeper
    }
    InsertChunk(database, 9, 0, 0, std::string(400'000, 'x'));
  };
  ASSERT_OK(store->CommitDeletion([&](Database& database) {
    DeleteJob(database, 7);
    request = std::thread([&] { EXPECT_FALSE(store->Commit(change).ok()); });
    AwaitThat([&] { return store->counts().pending_writes == 2; });
  }));
  request.join();
  ASSERT_TRUE(flush.joinable());
  flush.join();
  AwaitWritten(*store);
}

// The store is closed before the record fits.
TEST_F(DiskFailure, AFlushIsNotOkIfItsRecordsAreDropped) {
  const auto store = Open({.max_pending_bytes = 1000, .reserve_bytes = 0});
  LeaveRoomFor(100'000);
  std::promise<void> has_record;
  const auto post = [&](const absl::Status&) {
    RecordResult(*store, 0, 400'000);
    has_record.set_value();
    store->AwaitRoom();  // there is none: until the store is being closed
  };
  store->RecordSoon([](Database&) {}, post);
  has_record.get_future().wait();
  std::thread flushing([&] { EXPECT_FALSE(store->Flush().ok()); });
  AwaitThat([&] { return store->counts().pending_writes == 2; });
  store->Close();
  flushing.join();
}

// Some of many records fit. The store writes them in smaller groups.
TEST_F(DiskFailure, OnAFullDiskRecordsThatFitAreWritten) {
  const auto store = Open({.delay = kUnreachedLimit, .reserve_bytes = 0});
  LeaveRoomFor(300'000);
  for (int64_t point = 0; point < 1000; ++point) RecordResult(*store, point, 1000);
  EXPECT_FALSE(store->Flush().ok());
  AwaitThat([&] { return store->counts().pending_writes < 900; });
  EXPECT_GT(store->counts().pending_writes, 100);
}

TEST_F(DiskFailure, WorkersWaitWhenTheirResultsTakeTooMuchMemory) {
  const auto store = Open({.max_pending_bytes = 1000});
  disk_.Refuse(Refusal::kWriteError);
  RecordResult(*store, 0, 1001);
  EXPECT_FALSE(store->Flush().ok());
  std::atomic<bool> has_room = false;
  std::thread worker([&] {
    store->AwaitRoom();
    has_room = true;
  });
  const int64_t refusals = disk_.refusals();
  AwaitThat([&] { return disk_.refusals() >= refusals + 3; });
  EXPECT_FALSE(has_room);
  disk_.StopRefusing();
  worker.join();
}

// The delay collects small batches. It does not delay threads that wait for room.
TEST_F(DiskFailure, ManyWritesAreNotDelayed) {
  const auto store = Open({.delay = kUnreachedLimit, .max_pending = 10});
  std::promise<void> stored;
  for (int64_t point = 0; point < 6; ++point) {
    store->RecordResult(kJob, {.point = point, .samples = 1, .result = "x"}, [&](int64_t number) {
      if (number == 6) stored.set_value();
    });
  }
  EXPECT_EQ(stored.get_future().wait_for(kPatience), std::future_status::ready);
}

// ---- power_cut.h ----

TEST(PowerCut, AnInterruptedCreationIsCompletedAtTheNextStart) {
  FaultDisk disk;
  ASSERT_TRUE(OpenStoreFile(kStorePath).ok());
  const std::vector<DiskOperation> operations = disk.operations();
  ASSERT_GT(operations.size(), 10u);
  for (size_t cut = 0; cut <= operations.size(); ++cut) {
    for (const Survival survival : kSurvivals) {
      FaultDisk left(AfterPowerCut({}, operations, cut, survival, 1));
      const auto database = OpenStoreFile(kStorePath);
      ASSERT_TRUE(database.ok()) << database.status() << " at " << cut;
      EXPECT_EQ((*database)->First<std::string>("PRAGMA integrity_check"), "ok");
      EXPECT_EQ((*database)->Integer("PRAGMA user_version"), kSchemaVersion);
      EXPECT_EQ((*database)->Integer("SELECT count(*) FROM jobs"), 0);
    }
  }
}

}  // namespace
}  // namespace ballpiston::server
