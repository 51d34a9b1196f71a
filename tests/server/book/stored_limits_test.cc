// How long results are kept. The test sets the time.
#include "server/rpc/request_check.h"
#include "server/rpc/watch.h"
#include "server/store/check_store.h"
#include "server/store/sweeper.h"
#include "tests/server/book/book_test.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr absl::Duration kDay = absl::Hours(24);

// Keeps the messages of a watch.
struct KeepingReader : WatchReader {
  const Principal& caller() const override { return kRoot; }
  absl::Status Proceed() override { return absl::OkStatus(); }
  std::chrono::steady_clock::time_point next_check() const override {
    return std::chrono::steady_clock::time_point::max();
  }
  int64_t watches() const override { return 1; }
  bool Write(const v1::WatchEnsembleJobResponse& message) override {
    messages.push_back(message);
    if (messages.size() == 1 && after_first) after_first();
    return true;
  }

  std::vector<v1::WatchEnsembleJobResponse> messages;
  std::function<void()> after_first;
};

class StoredLimitsTest : public BookTest {
 protected:
  static v1::CreateEnsembleJobRequest Request(uint64_t seed, int points = 3) {
    return CreateRequest(Equilibrium(points, 5, seed));
  }

  // The id of a job that has succeeded.
  std::string Done(const Principal& caller, uint64_t seed, int points = 3) {
    return Answered(caller, Request(seed, points));
  }

  size_t PointsOf(const std::string& id) {
    return book_->Results(kRoot, id, {.max_points = 1000, .max_bytes = 1 << 20})
        .value()
        .points.size();
  }

  std::string ResultsError(const std::string& id) {
    return ReasonOf(book_->Results(kAnn, id, {.max_points = 10}).status());
  }

  // Watches the job to its end. Returns the messages, or the error.
  absl::StatusOr<std::vector<v1::WatchEnsembleJobResponse>> Watched(
      const std::string& id, const std::string& resume_token = "",
      std::function<void()> after_first = nullptr) {
    KeepingReader reader;
    reader.after_first = std::move(after_first);
    const absl::Status status = RunWatch(*book_, WatchTiming(), "this process",
                                         WatchRequest(JobName(id), resume_token), reader);
    if (!status.ok()) return status;
    return reader.messages;
  }

  void ExpectSound() {
    Stop();
    ASSERT_OK_AND_ASSIGN(const StoreSummary summary, CheckStore(path_));
    EXPECT_THAT(summary.problems, IsEmpty());
  }
};

TEST_F(StoredLimitsTest, ResultsExpireAndTheSpecificationStays) {
  Start({.retain_days = 30});
  const std::string id = Done(kAnn, 1);
  const EnsembleJob before = Get(id);
  const absl::Time end = absl::FromUnixSeconds(before.end_time().seconds());
  EXPECT_NEAR(static_cast<double>(before.expire_time().seconds() - before.end_time().seconds()),
              30 * 86400, 1);
  EXPECT_EQ(book_->CountExpiring(end), 0);
  EXPECT_EQ(book_->CountExpiring(end + 29 * kDay), 1);
  book_->KeepLimits(end + 29 * kDay);
  EXPECT_EQ(PointsOf(id), 3u);
  book_->KeepLimits(end + 30 * kDay + absl::Seconds(2));
  EXPECT_EQ(ResultsError(id), "RESULTS_EXPIRED");
  const EnsembleJob after = Get(id);
  EXPECT_TRUE(after.results_expired());
  EXPECT_FALSE(after.has_expire_time());
  EXPECT_EQ(after.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(after.spec().SerializeAsString(), before.spec().SerializeAsString());
  EXPECT_LT(after.stored_bytes(), before.stored_bytes());
  ExpectSound();
}

TEST_F(StoredLimitsTest, APinnedJobDoesNotExpire) {
  Start({.retain_days = 1});
  const std::string pinned = Done(kAnn, 1), other = Done(kAnn, 2);
  ASSERT_OK_AND_ASSIGN(const EnsembleJob job, book_->Update(kAnn, pinned, {.pinned = true}));
  EXPECT_TRUE(job.pinned());
  EXPECT_FALSE(job.has_expire_time());
  book_->KeepLimits(absl::Now() + 100 * kDay);
  EXPECT_EQ(PointsOf(pinned), 3u);
  EXPECT_EQ(ResultsError(other), "RESULTS_EXPIRED");
  EXPECT_OK(book_->Update(kAnn, pinned, {.pinned = false}));
  book_->KeepLimits(absl::Now() + 100 * kDay);
  EXPECT_EQ(ResultsError(pinned), "RESULTS_EXPIRED");
  EXPECT_EQ(ReasonOf(book_->Update(kAnn, pinned, {.pinned = true})), "RESULTS_EXPIRED");
  EXPECT_EQ(ReasonOf(book_->Update(kBen, other, {.pinned = true})), "JOB_NOT_FOUND");
}

// The job was pinned after retention had found that its results may expire.
TEST_F(StoredLimitsTest, AJobThatWasPinnedMeanwhileDoesNotExpire) {
  const std::string id = Done(kAnn, 1);
  ASSERT_OK(book_->Update(kAnn, id, {.pinned = true}));
  ASSERT_OK(store_->CommitDeletion([&](Database& database) {
    ExpireJob(database, FindJob(database, id, Grid::kLeftOut)->sequence);
  }));
  EXPECT_FALSE(Get(id).results_expired());
  EXPECT_EQ(PointsOf(id), 3u);
}

// The results are still there: the sweeper does not know yet that they have expired, because they
// expire in a commit that is not a deletion.
TEST_F(StoredLimitsTest, AWatchOfExpiredResultsHasNoPartOfThem) {
  const std::string id = Done(kAnn, 1, 200);
  ASSERT_OK_AND_ASSIGN(const auto whole, Watched(id));
  ASSERT_THAT(whole, SizeIs(3));  // 100 points, 100 points, the end
  ASSERT_OK(store_->Commit([&](Database& database) {
    ExpireJob(database, FindJob(database, id, Grid::kLeftOut)->sequence);
  }));
  ASSERT_OK_AND_ASSIGN(const FoundJob found, book_->Find(kRoot, id, Grid::kLeftOut));
  ASSERT_OK_AND_ASSIGN(const auto points, book_->FinishedAfter(found.record, nullptr, 0, 100));
  EXPECT_THAT(points, IsEmpty());
  for (const std::string& token : {std::string(), whole.back().resume_token()}) {
    ASSERT_OK_AND_ASSIGN(const auto end, Watched(id, token));
    ASSERT_THAT(end, SizeIs(1));
    EXPECT_TRUE(end.back().job().results_expired());
  }
  EXPECT_EQ(ReasonOf(Watched(id, whole[0].resume_token())), "RESULTS_EXPIRED");
  // The watch of an active job has received the job only, and no points.
  auto token = *ParseToken<storage::ResumeToken>(whole[0].resume_token());
  token.set_finished(0);
  EXPECT_EQ(ReasonOf(Watched(id, TokenText(token))), "RESULTS_EXPIRED");
}

// The sweeper has removed some of the rows that the watch has not read yet.
TEST_F(StoredLimitsTest, AWatchEndsWithAnErrorIfResultsExpireMeanwhile) {
  const std::string id = Done(kAnn, 1, 200);
  const auto expire = [&] {
    ASSERT_OK(store_->Commit([&](Database& database) {
      const int64_t job = FindJob(database, id, Grid::kLeftOut)->sequence;
      ExpireJob(database, job);
      database.Run("DELETE FROM results WHERE job = ? AND finish <= 150", job);
    }));
  };
  EXPECT_EQ(ReasonOf(Watched(id, "", expire)), "RESULTS_EXPIRED");
}

// The principal with the most bytes loses results first. Its oldest results expire first. Then
// expired jobs are deleted. If pinned jobs still take too much, no job is accepted.
TEST_F(StoredLimitsTest, TheStoreKeepsItsBound) {
  constexpr int64_t kBound = 600'000;
  Start({.max_store_bytes = kBound});
  const std::string bens = Done(kBen, 31, 300);
  std::vector<std::string> ids;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    ids.push_back(Done(kAnn, seed, 300));
    book_->KeepLimits(absl::Now());
    AwaitThat([this] { return !ReadFrom(*store_, &IsSweeping); });
    EXPECT_LT(ReadFrom(*store_, &UsedBytes), kBound);
  }
  EXPECT_TRUE(Get(ids.front()).results_expired());
  EXPECT_EQ(PointsOf(ids.back()), 300u);
  EXPECT_EQ(PointsOf(bens), 300u);
  const int64_t free_pages = ReadFrom(
      *store_, [](Database& database) { return database.Integer("PRAGMA freelist_count"); });
  EXPECT_LE(free_pages, kKeptPages);
  bool expired = true;
  for (const std::string& id : ids) {
    const bool now = Get(id).results_expired();
    EXPECT_TRUE(expired || !now) << "a newer job expired first";
    expired = now;
  }
  ExpectSound();
}

// The rows of small jobs take more than their questions. No job is refused because of jobs that can
// be deleted.
TEST_F(StoredLimitsTest, ManySmallJobsKeepTheBound) {
  constexpr int64_t kBound = 180'000;
  Start({.max_store_bytes = kBound});
  ASSERT_OK(store_->Commit([](Database& database) {
    for (int i = 0; i < 1'000; ++i) {
      JobRecord record;
      record.id = std::to_string(i);
      record.job.set_principal(kAnn.name);
      record.job.mutable_progress()->set_points(1);
      InsertJob(database, record);
      JobEnd end;
      end.numbers.bytes = BytesOfJob(record.job);
      EndJob(database, record.sequence, end);
    }
  }));
  EXPECT_GT(ReadFrom(*store_, &UsedBytes), kBound);
  EXPECT_OK(Create(kBen, Request(1)));
  book_->KeepLimits(absl::Now());
  EXPECT_LT(ReadFrom(*store_, &UsedBytes), kBound);
}

TEST_F(StoredLimitsTest, OnlyAnAdminPinsMoreThanHalfOfTheStore) {
  Start({.max_store_bytes = 200'000});
  const std::string first = Done(kAnn, 1, 300), second = Done(kAnn, 2, 600);
  ASSERT_OK(book_->Update(kAnn, first, {.pinned = true}));
  const absl::Status refused = book_->Update(kAnn, second, {.pinned = true}).status();
  EXPECT_THAT(refused, IsError(absl::StatusCode::kResourceExhausted, "TOO_MANY_PINNED_BYTES"));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("permits 100000"));
  EXPECT_OK(book_->Update(kAnn, first, {.pinned = true}));
  EXPECT_OK(book_->Update(kRoot, second, {.pinned = true}));
}

TEST_F(StoredLimitsTest, AnActiveJobIsPinnedWithItsResults) {
  Start({.max_store_bytes = 200'000});
  held_from_ = 600;
  const std::string active = Id(kAnn, Request(kHeldSeed, 601));
  AwaitThat([&] { return Get(active).progress().points_done() == 600; });
  EXPECT_EQ(ReasonOf(book_->Update(kAnn, active, {.pinned = true}).status()),
            "TOO_MANY_PINNED_BYTES");
}

TEST_F(StoredLimitsTest, APinnedActiveJobCountsOnce) {
  const std::string active = Id(kAnn, Request(kHeldSeed, 900));
  ASSERT_OK(book_->Update(kAnn, active, {.pinned = true}));
  Start({.max_store_bytes = static_cast<int64_t>(1.5 * Get(active).stored_bytes())});
  EXPECT_OK(Create(kBen, Request(1)));
}

TEST_F(StoredLimitsTest, AStoreFullOfPinnedJobsRejectsNewJobs) {
  Start({.max_store_bytes = 200'000});
  const std::string pinned = Id(kAnn, Request(1, 900));
  ASSERT_OK(book_->Update(kRoot, pinned, {.pinned = true}));
  AwaitEnd(pinned);
  book_->KeepLimits(absl::Now());
  const absl::Status refused = Create(kBen, Request(2)).status();
  EXPECT_THAT(refused, IsError(absl::StatusCode::kResourceExhausted, "TOO_MANY_STORED_BYTES"));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("--max-store-bytes"));
  EXPECT_EQ(PointsOf(pinned), 900u);
  ASSERT_OK(book_->Update(kAnn, pinned, {.pinned = false}));
  EXPECT_OK(Create(kBen, Request(2)));  // the results of the unpinned job can expire now
}

// An active job's results count when it ends.
TEST_F(StoredLimitsTest, JobsAndBytesOfEachPrincipalAreCounted) {
  const std::string first = Done(kAnn, 1), second = Done(kAnn, 2);
  Done(kBen, 3);
  const auto before = book_->JobsByPrincipal();
  EXPECT_EQ(before.at(0).principal(), "ann");
  EXPECT_EQ(before.at(0).stored_jobs(), 2);
  EXPECT_EQ(before.at(0).stored_bytes(), Get(first).stored_bytes() + Get(second).stored_bytes());
  EXPECT_EQ(before.at(1).principal(), "ben");
  EXPECT_EQ(before.at(1).stored_jobs(), 1);
  EXPECT_EQ(ReasonOf(book_->Result(kAnn, second, 3)), "RESULT_NOT_FOUND");
  ASSERT_OK(book_->Delete(kAnn, first));
  EXPECT_EQ(book_->JobsByPrincipal().at(0).stored_jobs(), 1);
  EXPECT_EQ(book_->JobsByPrincipal().at(0).stored_bytes(), Get(second).stored_bytes());
}

}  // namespace
}  // namespace ballpiston::server
