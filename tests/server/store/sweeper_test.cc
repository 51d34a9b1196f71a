#include "server/store/sweeper.h"

#include "server/store/backup.h"
#include "server/store/schema.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr uintmax_t kMiB = 1 << 20;

class SweeperTest : public testing::Test {
 protected:
  // A store in which job 7 is dropped, with so many results of so many bytes.
  std::unique_ptr<Database> WithDroppedJob(int rows, int bytes) const {
    auto database = *OpenStoreFile(path_);
    database->Execute(
        absl::StrCat("WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < ",
                     rows - 1, ") INSERT INTO results SELECT 7, i, 1, i, 0, x'', zeroblob(", bytes,
                     "), x'' FROM n;", "INSERT INTO dropped (job) VALUES (7)"));
    EXPECT_OK(database->status());
    return database;
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("store.sqlite3");
};

TEST_F(SweeperTest, ARestartGoesOnWithTheRestAndTheFileShrinks) {
  WithDroppedJob(1000, 20'000)
      ->Execute("INSERT INTO results VALUES (8, 3, 1, 1, 0, x'00', x'', x'')");
  ASSERT_GT(std::filesystem::file_size(path_), 19 * kMiB);  // 5 pages a result
  const auto store = *Store::Open(path_, {.stall = kUnreachedLimit, .reserve_bytes = 0});
  ASSERT_OK(store->Flush());
  AwaitThat([this] { return std::filesystem::file_size(path_) <= 3 * kMiB; });  // 256 free pages
  const auto count = [&](const std::string& table) {
    return ReadFrom(*store, [&](Database& database) {
      return database.Integer("SELECT count(*) FROM " + table);
    });
  };
  EXPECT_EQ(count("dropped"), 0);
  EXPECT_EQ(count("results"), 1);
}

// Another write need not wait for many rows.
TEST_F(SweeperTest, AStepRemovesFewRows) {
  const auto database = WithDroppedJob(10'000, 300);
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
