#include "server/book/job.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/book/job_book.h"
#include "server/book/job_journal.h"
#include "server/book/job_message.h"
#include "server/book/job_name.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/store/job_table.h"
#include "server/store/point_tables.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/hanging_disk.h"
#include "tests/server/store_access.h"
#include "tests/server/thread_pool.h"
#include "tests/support/await.h"
#include "tests/support/nightly.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;

JobRecord JobWithPoints(int64_t points) {
  JobRecord record;
  record.sequence = 1;
  record.id = "a";
  record.points = points;
  return record;
}

FinishedPoint FinishedPointOf(int number) {
  return {number, std::make_shared<const std::string>(std::to_string(number))};
}

std::vector<int64_t> Numbers(const std::vector<FinishedPoint>& points) {
  std::vector<int64_t> numbers;
  for (const FinishedPoint& point : points) numbers.push_back(point.number);
  return numbers;
}

// Points that an earlier process finished.
std::vector<PointSize> RestoredPoints(size_t count) {
  return std::vector<PointSize>(count, {.point = 0, .samples = 100, .bytes = 1});
}

TEST(Job, ProgressIsTheShareOfWorkDone) {
  Job job(JobWithPoints(4));
  job.AddRestoredPoints(RestoredPoints(1));
  job.Add({.samples = 50, .points_computed = 0.5});
  const v1::JobProgress progress = job.Progress();
  EXPECT_EQ(progress.points(), 4);
  EXPECT_EQ(progress.points_done(), 1);
  EXPECT_EQ(progress.samples(), 150);
  EXPECT_EQ(progress.fraction(), 1.5 / 4);
}

TEST(Job, AToleranceGivesNoFraction) {
  v1::EnsembleSpec spec;
  spec.mutable_target()->set_tolerance(0.1);
  JobRecord record = JobWithPoints(4);
  record.spec = SpecBytes(spec);
  EXPECT_FALSE(Job(record).Progress().has_fraction());
}

TEST(Job, APointIsDoneWhenItIsStored) {
  Job job(JobWithPoints(2));
  EXPECT_EQ(job.Progress().points_done(), 0);
  const uint64_t before = job.last_change();
  job.AddFinishedPoint(FinishedPointOf(1));
  EXPECT_EQ(job.Progress().points_done(), 1);
  EXPECT_EQ(job.last_finished(), 1);
  EXPECT_GT(job.last_change(), before);
}

TEST(Job, FinishedPointsComeInTheirOrderAndTheNewestAreKept) {
  Job job(JobWithPoints(1000));
  for (int number = 1; number <= 300; ++number) job.AddFinishedPoint(FinishedPointOf(number));
  const auto last = static_cast<int64_t>(300 - kRecentPoints);
  EXPECT_EQ(job.FinishedAfter(last - 1, 10), std::nullopt);
  EXPECT_EQ(job.FinishedAfter(last, 1000)->size(), kRecentPoints);
  EXPECT_THAT(Numbers(*job.FinishedAfter(250, 3)), testing::ElementsAre(251, 252, 253));
  EXPECT_THAT(Numbers(*job.FinishedAfter(298, 10)), testing::ElementsAre(299, 300));
  EXPECT_TRUE(job.FinishedAfter(300, 10)->empty());
}

TEST(Job, RestoredPointsAreNotKept) {
  Job job(JobWithPoints(1000));
  job.AddRestoredPoints(RestoredPoints(70));
  EXPECT_EQ(job.last_finished(), 70);
  EXPECT_EQ(job.FinishedAfter(69, 10), std::nullopt);
  EXPECT_TRUE(job.FinishedAfter(70, 10)->empty());
  job.AddFinishedPoint(FinishedPointOf(75));
  EXPECT_THAT(Numbers(*job.FinishedAfter(70, 10)), testing::ElementsAre(75));
  EXPECT_EQ(job.Progress().points_done(), 71);
}

TEST(SharedCopy, AnOldCopyIsReplacedIfTheJobHasChanged) {
  SharedCopy<JobSnapshot> shared;
  uint64_t made = 0;
  const auto make = [&made]() -> absl::StatusOr<JobSnapshot> {
    JobSnapshot snapshot;
    snapshot.change = ++made;
    return snapshot;
  };
  const auto ever = std::chrono::hours(1);
  const auto never = std::chrono::milliseconds(0);
  const auto first = *shared.Get(1, ever, make);
  EXPECT_EQ(*shared.Get(2, ever, make), first);   // young
  EXPECT_EQ(*shared.Get(1, never, make), first);  // nothing changed
  const auto second = *shared.Get(2, never, make);
  EXPECT_EQ(second->change, 2u);
  EXPECT_EQ(made, 2u);
  shared.Drop();
  EXPECT_EQ((*shared.Get(2, ever, make))->change, 3u);
}

class JobJournalTest : public testing::Test {
 protected:
  // Nothing is committed before it is flushed.
  void SetUp() override {
    ASSERT_OK_AND_ASSIGN(store_,
                         Store::Open(folder_.File("store"), {.delay = kNever, .stall = kNever}));
    record_ = JobWithPoints(3);
    ASSERT_OK(store_->Commit([this](Database& database) { InsertJob(database, record_); }));
    job_ = std::make_shared<Job>(record_);
    journal_.emplace(job_, *store_, false, nullptr);
  }

  JobRecord Row(const std::string& id) {
    return *ReadFrom(*store_,
                     [&](Database& database) { return FindJob(database, id, Grid::kIncluded); });
  }
  JobRecord Row() { return Row(record_.id); }

  void Finish(size_t point) {
    const EnsembleSpec spec = FakeSpec(3, 1);
    const auto experiment = FakeExperiments()(spec, point);
    PointFold fold(*experiment);
    fold.Resume({.chunk = 1, .complete = FakeMerged(spec, point, 1)});
    journal_->PointFinished(point, *experiment, fold);
  }

  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
  JobRecord record_;
  std::shared_ptr<Job> job_;
  std::optional<JobJournal> journal_;
};

TEST_F(JobJournalTest, OnlyStoredChangesAreSent) {
  journal_->Began();
  Finish(2);
  Finish(0);
  EXPECT_EQ(Row().state, EnsembleJob::QUEUED);
  EXPECT_EQ(job_->last_finished(), 0);
  ASSERT_OK(store_->Flush());
  EXPECT_EQ(Row().state, EnsembleJob::RUNNING);
  const auto told = *job_->FinishedAfter(0, 10);
  EXPECT_THAT(Numbers(told), testing::ElementsAre(1, 2));
  EXPECT_EQ(ResultFromBytes(*told[0].result)->index(), 2);
  EXPECT_EQ(ResultFromBytes(*told[1].result)->index(), 0);
}

TEST_F(JobJournalTest, TheStoreHasThePointsUnderTheSameNumbers) {
  for (const size_t point : {2u, 0u, 1u}) Finish(point);
  Finish(0);  // the first writer wins: no number for this one
  ASSERT_OK(store_->Flush());
  std::vector<std::pair<int64_t, int64_t>> stored;
  ASSERT_OK(store_->Read([&](Database& database) {
    ReadResultsStoredAfter(database, record_.sequence, 1,
                           [&](int64_t number, const std::string& result) {
                             stored.emplace_back(number, ResultFromBytes(result)->index());
                             return true;
                           });
  }));
  EXPECT_THAT(stored, testing::ElementsAre(testing::Pair(2, 0), testing::Pair(3, 1)));
  EXPECT_EQ(job_->last_finished(), 3);
}

// The points are stored only after Ended was called.
TEST_F(JobJournalTest, TheEndCountsPointsThatAreNotStoredYet) {
  for (const size_t point : {0u, 1u, 2u}) Finish(point);
  journal_->Ended(absl::OkStatus());
  ASSERT_OK(store_->Flush());
  EXPECT_EQ(Row().state, EnsembleJob::SUCCEEDED);
  EXPECT_EQ(Row().numbers.points_done, 3);
  EXPECT_EQ(job_->Progress().points_done(), 3);
}

TEST_F(JobJournalTest, AJobWithMissingResultsFails) {
  for (const size_t point : {0u, 2u}) Finish(point);
  journal_->Ended(absl::OkStatus());
  ASSERT_OK(store_->Flush());
  const EnsembleJob job = JobMessage(Row(), {}, 0);
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(), testing::HasSubstr("of 3 computed points the store keeps 2"));
}

// Otherwise the job would be active until the next start of the server.
TEST_F(JobJournalTest, AJobWhoseEndTheStoreRejectsFails) {
  ASSERT_OK(store_->Commit([](Database& database) {
    database.Execute(
        "CREATE TRIGGER no_success BEFORE UPDATE ON jobs WHEN new.state = 4"
        " BEGIN SELECT RAISE(ABORT, 'not this one'); END");
  }));
  std::vector<JobState> ends;
  journal_.emplace(job_, *store_, false,
                   [&](const JobRecord& ended) { ends.push_back(ended.state); });
  for (const size_t point : {0u, 1u, 2u}) Finish(point);
  const uint64_t change = job_->last_state_change();
  journal_->Ended(absl::OkStatus());
  ASSERT_OK(store_->Flush());  // the rejected end
  ASSERT_OK(store_->Flush());
  const EnsembleJob job = JobMessage(Row(), {}, 0);
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(), testing::HasSubstr("not this one"));
  EXPECT_EQ(Row().numbers.points_done, 3);
  EXPECT_THAT(ends, testing::ElementsAre(EnsembleJob::FAILED));
  EXPECT_GT(job_->last_state_change(), change);
}

// Two runs end the same jobs, one in success and one in failure, while a client cancels them.
TEST_F(JobJournalTest, TheFirstEndOfAJobIsItsEnd) {
  std::vector<JobRecord> records(IsNightly() ? 10'000 : 1'000, JobWithPoints(0));
  for (size_t i = 0; i < records.size(); ++i) records[i].id = absl::StrCat("job-", i);
  ASSERT_OK(store_->Commit([&](Database& database) {
    for (JobRecord& record : records) InsertJob(database, record);
  }));
  std::map<std::string, std::vector<JobState>> ends;  // the store's thread writes them
  const auto note = [&](const JobRecord& ended) { ends[ended.id].push_back(ended.state); };
  const auto end_all = [&](const absl::Status& outcome) {
    for (const JobRecord& record : records) {
      const auto job = std::make_shared<Job>(record);
      JobJournal(job, *store_, false, note).Ended(outcome);
    }
  };
  std::thread succeeds(end_all, absl::OkStatus());
  std::thread fails(end_all, absl::InternalError("why"));
  for (const JobRecord& record : records) {
    store_->RecordSoon([sequence = record.sequence](Database& database) {
      BeginCancellation(database, sequence, "");
    });
  }
  succeeds.join();
  fails.join();
  ASSERT_OK(store_->Flush());
  for (const JobRecord& record : records) {
    const JobState state = Row(record.id).state;
    EXPECT_THAT(ends[record.id], testing::ElementsAre(state)) << record.id;
    EXPECT_TRUE(HasEnded(state));
    EXPECT_EQ(Row(record.id).error.empty(), state != EnsembleJob::FAILED);
  }
}

// The store's thread calls the book when it has written the end of a job.
TEST(JobBook, IsDestroyedAfterTheLastWriteOfAHangingDisk) {
  const TemporaryFolder folder;
  HangingDisk disk;
  const auto store = *Store::Open(folder.File("store"),
                                  {.stall = std::chrono::milliseconds(1), .vfs = disk.vfs()});
  ThreadPool pool(1, FakeExperiments());
  auto book = std::make_unique<JobBook>(*store, Limits(), pool.scheduler());
  const auto write = [](Database& database) { InsertChunk(database, 9, 0, 0, "x"); };
  disk.Hang();
  store->RecordSoon(write);
  disk.AwaitHanging();
  store->Record(write);
  AwaitThat([&] { return store->stalled(); });
  std::atomic<bool> is_destroyed = false;
  int64_t pending = -1;
  std::thread destroys([&] {
    book.reset();
    pending = store->counts().pending_writes;
    is_destroyed = true;
  });
  // Waits until the destructor closes the store: a closing store rejects records.
  const auto is_closing = std::make_shared<std::atomic<bool>>(false);
  AwaitThat([&] {
    store->Record(write, [is_closing](const absl::Status& done) { *is_closing = !done.ok(); });
    return *is_closing || is_destroyed;
  });
  disk.Resume();
  destroys.join();
  EXPECT_EQ(pending, 0);
}

TEST(LeaveOutFinished, APointInBothListsIsKeptAsFinishedOnly) {
  v1::StatisticsSnapshot message;
  for (const int index : {4, 2, 7}) message.add_points()->set_index(index);
  for (const int index : {1, 2}) message.add_finished_points()->set_index(index);
  LeaveOutFinished(message);
  ASSERT_EQ(message.points_size(), 2);
  EXPECT_EQ(message.points(0).index(), 4);
  EXPECT_EQ(message.points(1).index(), 7);
  EXPECT_EQ(message.finished_points_size(), 2);
}

TEST(JobName, OnlyJobsHaveJobNames) {
  EXPECT_EQ(JobIdOf("ensembleJobs/0a-9"), "0a-9");
  const std::string too_long(64, 'a');
  for (const std::string& name :
       {std::string(), std::string("ensembleJobs/"), "jobs/a" + too_long,
        std::string("ensembleJobs/A"), std::string("ensembleJobs/a/b"), "ensembleJobs/" + too_long,
        std::string("a"), std::string("ensembleJobs/a b")}) {
    EXPECT_EQ(JobIdOf(name), std::nullopt) << name;
  }
  EXPECT_TRUE(JobIdOf(JobName(RandomId())));
  EXPECT_NE(RandomId(), RandomId());
}

}  // namespace
}  // namespace ballpiston::server
