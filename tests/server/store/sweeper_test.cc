#include "server/store/sweeper.h"

#include "server/store/backup.h"
#include "server/store/schema.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr int64_t kMiB = 1 << 20;

class SweeperTest : public testing::Test {
 protected:
  std::unique_ptr<Store> Open() {
    return *Store::Open(path_, {.stall = kUnreachedLimit, .readers = 1, .reserve_bytes = 0});
  }
  int64_t FileBytes() const { return static_cast<int64_t>(std::filesystem::file_size(path_)); }

  // 20 MB of details.
  static int64_t AddLargeJob(Store& store, const std::string& id) {
    JobRecord record;
    record.id = id;
    constexpr int32_t kPoints = 1000;
    record.job.mutable_progress()->set_points(kPoints);
    EXPECT_OK(store.Commit([&](Database& database) { InsertJob(database, record); }));
    for (int64_t point = 0; point < kPoints; ++point) {
      store.RecordResult(record.sequence,
                         {.point = point, .result = "r", .details = std::string(20'000, 'd')});
    }
    EXPECT_OK(store.Flush());
    EXPECT_OK(store.Commit([&](Database& database) {
      JobEnd end;
      end.numbers.points_done = kPoints;
      EndJob(database, record.sequence, end);
    }));
    return record.sequence;
  }

  static void Delete(Store& store, int64_t job) {
    ASSERT_OK(store.CommitDeletion([=](Database& database) { DeleteJob(database, job); }));
  }

  static int64_t Count(Store& store, const std::string& table) {
    return ReadFrom(store, [&](Database& database) {
      return database.Integer("SELECT count(*) FROM " + table);
    });
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("store.sqlite3");
};

TEST_F(SweeperTest, TheFileShrinksWhenAJobIsDeleted) {
  const auto store = Open();
  const int64_t first = AddLargeJob(*store, "a");
  AddLargeJob(*store, "b");
  Delete(*store, first);
  AwaitThat([this] { return FileBytes() <= 23 * kMiB; });  // 5 pages a point, and 256 free ones
  EXPECT_EQ(Count(*store, "results"), 1000);
  EXPECT_GT(FileBytes(), 20 * kMiB);  // those of "b"
}

TEST_F(SweeperTest, ARestartGoesOnWithTheRest) {
  {
    const auto database = *OpenStoreFile(path_);
    database->Execute(
        "INSERT INTO dropped (job) VALUES (7);"
        "INSERT INTO results VALUES (7, 3, 1, 1, 0, x'00', x'', x''),"
        " (8, 3, 1, 1, 0, x'00', x'', x'')");
    ASSERT_OK(database->status());
  }
  const auto store = Open();
  ASSERT_OK(store->Flush());
  AwaitThat([&] { return Count(*store, "dropped") == 0; });
  EXPECT_EQ(Count(*store, "results"), 1);
}

// Another write need not wait for many rows.
TEST_F(SweeperTest, AStepRemovesFewRows) {
  const auto database = *OpenStoreFile(path_);
  database->Execute(
      "WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n"
      " WHERE i < 9999) INSERT INTO results SELECT 7, i, 1, i, 0, x'', zeroblob(300), x'' FROM n;"
      "INSERT INTO dropped (job) VALUES (7)");
  const auto rows = [&] { return database->Integer("SELECT count(*) FROM results"); };
  ASSERT_TRUE(SweepStep(*database));
  EXPECT_EQ(rows(), 10'000 - kSweptRows);
  while (SweepStep(*database)) continue;
  EXPECT_EQ(rows(), 0);
  EXPECT_LE(database->Integer("PRAGMA freelist_count"), kKeptPages);
  EXPECT_OK(database->status());
}

TEST_F(SweeperTest, ABackupHasNoFreePages) {
  {
    const auto database = *OpenStoreFile(path_);
    database->Execute("INSERT INTO checkpoints VALUES (1, 1, zeroblob(1000000))");
    database->Execute("DELETE FROM checkpoints");
    EXPECT_GT(database->Integer("PRAGMA freelist_count"), 200);
  }
  const std::string copy = folder_.File("copy");
  ASSERT_OK(BackupStore(path_, copy));
  const auto database = *OpenStoreToRead(copy);
  EXPECT_EQ(database->Integer("PRAGMA freelist_count"), 0);
  EXPECT_EQ(database->Integer("PRAGMA auto_vacuum"), 2);  // incremental, as in the store
}

}  // namespace
}  // namespace ballpiston::server
