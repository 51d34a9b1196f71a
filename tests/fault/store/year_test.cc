// A server's store under a steady load for a month, or in the long form for a year. The clock is
// the test's, so a day takes some seconds.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/book/retention.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"
#include "server/store/check_store.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"
#include "server/store/store.h"
#include "server/store/sweeper.h"
#include "tests/server/requests.h"
#include "tests/server/store_access.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

constexpr absl::Duration kDay = absl::Hours(24);
constexpr int kPoints = 20;
constexpr int kRetainDays = 30;
constexpr int64_t kMostFreePages = 300;  // the sweeper keeps 256, and commits free some more

bool IsLongYear() { return std::getenv("BALLPISTON_TORTURE") != nullptr; }

// In the long form a usual day has 1.5 MB, in the short form a tenth. A busy day has 4.5 or 1.5 MB:
// it frees more pages than may stay free.
int UsualJobs() { return IsLongYear() ? 40 : 4; }
int ManyJobs() { return IsLongYear() ? 120 : 40; }
int64_t Bound() { return 1'500'000 * int64_t{UsualJobs()}; }  // usual jobs fill three quarters

// Commits again and again, and measures the longest wait: for the writer and for the disk.
class Prober {
 public:
  explicit Prober(Store& store) : store_(store), thread_([this] { Probe(); }) {}
  ~Prober() {
    stop_ = true;
    thread_.join();
  }
  double TakeLongest() { return longest_.exchange(0); }  // in ms, since the last call

 private:
  void Probe() {
    while (!stop_) {
      const auto start = std::chrono::steady_clock::now();
      EXPECT_OK(store_.Commit([](Database&) {}));
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - start;
      longest_ = std::max(longest_.load(), took.count());
    }
  }

  Store& store_;
  std::atomic<bool> stop_ = false;
  std::atomic<double> longest_ = 0;
  std::thread thread_;
};

class YearTest : public testing::Test {
 protected:
  YearTest()
      : store_(*Store::Open(path_, {.delay = std::chrono::milliseconds(1), .stall = kNever})) {}

  // With 1.5 kB of details: a histogram of 190 bins.
  static PointRow Row(int64_t point) {
    v1::PointResult result;
    result.set_index(static_cast<int32_t>(point));
    result.set_reason(std::string(200, 'r'));
    return {point, 1e6, DeterministicBytes(result), LargeDetails(190), false};
  }

  void AddJob(absl::Time end) {
    JobRecord record;
    record.id = absl::StrCat("job-", ++jobs_);
    record.principal = "ann";
    record.spec = SpecBytes(Equilibrium(kPoints, 2, static_cast<uint64_t>(jobs_)));
    record.numbers.bytes = static_cast<int64_t>(record.spec.size());
    record.points = kPoints;
    ASSERT_OK(store_->Commit([&](Database& database) { InsertJob(database, record); }));
    JobEnd job_end;
    job_end.time = end;
    job_end.numbers.points_done = kPoints;
    job_end.numbers.bytes = record.numbers.bytes;
    for (int64_t point = 0; point < kPoints; ++point) {
      PointRow row = Row(point);
      job_end.numbers.bytes += static_cast<int64_t>(row.result.size() + row.details.size());
      store_->RecordResult(record.sequence, std::move(row));
    }
    store_->RecordSoon([=, sequence = record.sequence](Database& database) {
      EndJob(database, sequence, job_end);
    });
  }

  // All jobs of the day. Then enforces the limits, as a server does once a second.
  void Live(absl::Time day, int jobs) {
    for (int i = 0; i < jobs; ++i) AddJob(day);
    ASSERT_OK(store_->Flush());
    int64_t before = 0, after = 0;
    do {
      before = ReadFrom(*store_, CountExpired);
      ASSERT_OK(EnforceRetention(*store_, limits_, day + kDay));
      store_->AwaitSwept();
      after = ReadFrom(*store_, CountExpired);
    } while (after != before);
  }

  static int64_t CountExpired(Database& database) {
    return database.Integer("SELECT count(*) FROM jobs WHERE expired_time IS NOT NULL");
  }
  static int64_t FreePages(Database& database) { return database.Integer("PRAGMA freelist_count"); }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("store.sqlite3");
  std::unique_ptr<Store> store_;
  const Limits limits_ = {.retain_days = kRetainDays, .max_store_bytes = Bound()};
  int jobs_ = 0;
};

// For two weeks of each two months there are more jobs.
TEST_F(YearTest, TheStoreStaysWithinItsBounds) {
  const int days = IsLongYear() ? 365 : 60;
  const absl::Time start = absl::FromUnixSeconds(1'800'000'000);
  double longest = 0;
  Prober prober(*store_);
  std::cout << "day  MB in use  free pages  longest commit, ms  expired jobs\n";
  for (int day = 0; day < days; ++day) {
    const bool is_busy = day % 60 >= 40 && day % 60 < 54;
    Live(start + day * kDay, is_busy ? ManyJobs() : UsualJobs());
    const int64_t used = ReadFrom(*store_, UsedBytes);
    EXPECT_LE(used, Bound());
    EXPECT_LE(ReadFrom(*store_, FreePages), kMostFreePages);
    EXPECT_TRUE(day < kRetainDays || used > 2 * Bound() / 3)
        << used;  // results that may stay are kept
    const double hold = prober.TakeLongest();
    longest = std::max(longest, hold);
    if (day % 5 == 4) {
      absl::PrintF("%3d  %9.1f  %10d  %18.0f  %12d\n", day + 1, static_cast<double>(used) / 1e6,
                   ReadFrom(*store_, FreePages), hold, ReadFrom(*store_, CountExpired));
    }
  }
  absl::PrintF("the longest commit of all took %.0f ms\n", longest);
}

TEST_F(YearTest, TheStoreIsSoundAfterwards) {
  const absl::Time start = absl::FromUnixSeconds(1'800'000'000);
  for (int day = 0; day < 45; ++day) Live(start + day * kDay, 3);  // far within the bound
  EXPECT_EQ(ReadFrom(*store_, CountExpired), 3 * (45 - kRetainDays));
  store_->Close();
  ASSERT_OK_AND_ASSIGN(const StoreSummary summary, CheckStore(path_));
  EXPECT_THAT(summary.problems, testing::IsEmpty());
}

}  // namespace
}  // namespace ballpiston::server
