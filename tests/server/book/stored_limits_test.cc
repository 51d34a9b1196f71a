// How long results are kept. The test sets the time.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "server/book/job_book.h"
#include "server/book/job_name.h"
#include "server/store/check_store.h"
#include "server/store/sweeper.h"
#include "tests/server/error_details.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/store_access.h"
#include "tests/server/thread_pool.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using v1::EnsembleJob;

const Principal kAlice{"alice", Role::kSubmit};
const Principal kBob{"bob", Role::kSubmit};

MATCHER_P2(IsLimit, reason, flag, "") {
  return absl::IsResourceExhausted(arg) && ReasonOf(arg) == reason &&
         testing::ExplainMatchResult(HasSubstr(absl::StrCat("--", flag)),
                                     std::string(arg.message()), result_listener);
}

constexpr absl::Duration kDay = absl::Hours(24);

class StoredLimitsTest : public testing::Test {
 protected:
  ~StoredLimitsTest() override { Stop(); }

  void Start(const Limits& limits, ExperimentFactory factory = FakeExperiments()) {
    Stop();
    ASSERT_OK_AND_ASSIGN(store_, Store::Open(path_, {.delay = std::chrono::milliseconds(1),
                                                     .stall = kNever,
                                                     .reserve_bytes = 0}));
    pool_ = std::make_unique<ThreadPool>(2, std::move(factory));
    book_ = std::make_unique<JobBook>(*store_, limits, pool_->scheduler());
    ASSERT_OK(book_->Resume());
  }

  void Stop() {
    book_.reset();
    pool_.reset();
    store_.reset();
  }

  absl::StatusOr<EnsembleJob> Create(const Principal& caller, uint64_t seed, int points = 3) {
    const auto request = CreateRequest(Equilibrium(points, 5, seed));
    return book_->Create(caller, request, CheckSpec(request.spec()));
  }

  EnsembleJob Get(const Principal& caller, const std::string& id) {
    return book_->Get(caller, id).value();
  }

  void AwaitEnd(const Principal& caller, const std::string& id) {
    AwaitThat([&] { return HasEnded(Get(caller, id).state()); });
  }

  // The id of a job that has succeeded.
  std::string Done(const Principal& caller, uint64_t seed, int points = 3) {
    const std::string id = *JobIdOf(Create(caller, seed, points).value().name());
    AwaitEnd(caller, id);
    EXPECT_EQ(Get(caller, id).state(), EnsembleJob::SUCCEEDED);
    return id;
  }

  size_t PointsOf(const Principal& caller, const std::string& id) {
    return book_->Results(caller, id, {.max_points = 1000, .max_bytes = 1 << 20})
        .value()
        .points.size();
  }

  std::string ResultsError(const std::string& id) {
    return ReasonOf(book_->Results(kAlice, id, {.max_points = 10}).status());
  }

  void ExpectSound() {
    Stop();
    ASSERT_OK_AND_ASSIGN(const StoreSummary summary, CheckStore(path_));
    EXPECT_THAT(summary.problems, testing::IsEmpty());
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("store.sqlite3");
  std::unique_ptr<Store> store_;
  std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<JobBook> book_;
};

TEST_F(StoredLimitsTest, ResultsExpireAndTheSpecificationStays) {
  Start({.retain_days = 30});
  const std::string id = Done(kAlice, 1);
  const EnsembleJob before = Get(kAlice, id);
  const absl::Time end = absl::FromUnixSeconds(before.end_time().seconds());
  EXPECT_NEAR(static_cast<double>(before.expire_time().seconds() - before.end_time().seconds()),
              30 * 86400, 1);
  book_->KeepLimits(end + 29 * kDay);
  EXPECT_EQ(PointsOf(kAlice, id), 3u);
  book_->KeepLimits(end + 30 * kDay + absl::Seconds(2));
  EXPECT_EQ(ResultsError(id), "RESULTS_EXPIRED");
  const EnsembleJob after = Get(kAlice, id);
  EXPECT_TRUE(after.results_expired());
  EXPECT_FALSE(after.has_expire_time());
  EXPECT_EQ(after.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(after.spec().SerializeAsString(), before.spec().SerializeAsString());
  EXPECT_LT(after.stored_bytes(), before.stored_bytes());
  ExpectSound();
}

TEST_F(StoredLimitsTest, APinnedJobDoesNotExpire) {
  Start({.retain_days = 1});
  const std::string pinned = Done(kAlice, 1), other = Done(kAlice, 2);
  ASSERT_OK_AND_ASSIGN(const EnsembleJob job, book_->Update(kAlice, pinned, {.pinned = true}));
  EXPECT_TRUE(job.pinned());
  EXPECT_FALSE(job.has_expire_time());
  book_->KeepLimits(absl::Now() + 100 * kDay);
  EXPECT_EQ(PointsOf(kAlice, pinned), 3u);
  EXPECT_EQ(ResultsError(other), "RESULTS_EXPIRED");
  EXPECT_OK(book_->Update(kAlice, pinned, {.pinned = false}));
  book_->KeepLimits(absl::Now() + 100 * kDay);
  EXPECT_EQ(ResultsError(pinned), "RESULTS_EXPIRED");
  EXPECT_EQ(ReasonOf(book_->Update(kAlice, pinned, {.pinned = true}).status()), "RESULTS_EXPIRED");
  EXPECT_EQ(ReasonOf(book_->Update(kAlice, "nosuchjob", {.pinned = true}).status()),
            "JOB_NOT_FOUND");
  EXPECT_EQ(ReasonOf(book_->Update(kBob, other, {.pinned = true}).status()), "JOB_NOT_FOUND");
}

// The oldest results expire first. Then expired jobs are deleted. If pinned jobs still take too
// much, no job is accepted.
TEST_F(StoredLimitsTest, TheStoreKeepsItsBound) {
  constexpr int64_t kBound = 600'000;
  Start({.max_store_bytes = kBound});
  std::vector<std::string> ids;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    ids.push_back(Done(kAlice, seed, 300));
    book_->KeepLimits(absl::Now());
    AwaitThat([this] { return !ReadFrom(*store_, &IsSweeping); });
    EXPECT_LT(ReadFrom(*store_, &UsedBytes), kBound);
  }
  EXPECT_TRUE(Get(kAlice, ids.front()).results_expired());
  EXPECT_EQ(PointsOf(kAlice, ids.back()), 300u);
  const int64_t free_pages = ReadFrom(
      *store_, [](Database& database) { return database.Integer("PRAGMA freelist_count"); });
  EXPECT_LE(free_pages, kKeptPages);
  bool expired = true;
  for (const std::string& id : ids) {
    const bool now = Get(kAlice, id).results_expired();
    EXPECT_TRUE(expired || !now) << "a newer job expired first";
    expired = now;
  }
  ExpectSound();
}

TEST_F(StoredLimitsTest, AStoreFullOfPinnedJobsRejectsNewJobs) {
  Start({.max_store_bytes = 200'000});
  const std::string pinned = *JobIdOf(Create(kAlice, 1, 900)->name());
  ASSERT_OK(book_->Update(kAlice, pinned, {.pinned = true}));
  AwaitEnd(kAlice, pinned);
  book_->KeepLimits(absl::Now());
  const absl::Status refused = Create(kBob, 2).status();
  EXPECT_THAT(refused, IsLimit("TOO_MANY_STORED_BYTES", "max-store-bytes"));
  EXPECT_EQ(PointsOf(kAlice, pinned), 900u);
  ASSERT_OK(book_->Update(kAlice, pinned, {.pinned = false}));
  while (!Create(kBob, 2).ok()) book_->KeepLimits(absl::Now());
}

// An active job's results count when it ends.
TEST_F(StoredLimitsTest, JobsAndBytesOfEachPrincipalAreCounted) {
  Start({});
  const std::string first = Done(kAlice, 1), second = Done(kAlice, 2);
  Done(kBob, 3);
  const std::map<std::string, PrincipalJobs> before = book_->JobsByPrincipal();
  EXPECT_EQ(before.at("alice").stored, 2);
  EXPECT_EQ(static_cast<double>(before.at("alice").bytes),
            Get(kAlice, first).stored_bytes() + Get(kAlice, second).stored_bytes());
  EXPECT_EQ(before.at("bob").stored, 1);
  EXPECT_EQ(ReasonOf(book_->Result(kAlice, second, 3).status()), "RESULT_NOT_FOUND");
  ASSERT_OK(book_->Delete(kAlice, first));
  EXPECT_EQ(book_->JobsByPrincipal().at("alice").stored, 1);
  EXPECT_EQ(static_cast<double>(book_->JobsByPrincipal().at("alice").bytes),
            Get(kAlice, second).stored_bytes());
}

}  // namespace
}  // namespace ballpiston::server
