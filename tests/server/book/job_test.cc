#include "server/book/job.h"

#include "server/book/job_book.h"
#include "server/book/job_journal.h"
#include "server/convert/point_result.h"
#include "server/store/job_name.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

JobRecord JobWithPoints(int32_t points) {
  JobRecord record;
  record.sequence = 1;
  record.id = "a";
  record.job.mutable_progress()->set_points(points);
  return record;
}

TEST(Job, AToleranceGivesNoFraction) {
  EnsembleJob job = JobWithPoints(4).job;
  EXPECT_TRUE(ProgressOf(job, {}).has_fraction());
  job.mutable_spec()->mutable_target()->set_tolerance(0.1);
  EXPECT_FALSE(ProgressOf(job, {}).has_fraction());
}

TEST(Job, LabelsCountAmongItsBytes) {
  EnsembleJob job;
  const int64_t bytes = BytesOfJob(job);
  (*job.mutable_labels())["run"] = "12";
  EXPECT_EQ(BytesOfJob(job), bytes + 5);
}

TEST(Job, AnOldSnapshotIsReplacedIfTheJobHasChanged) {
  Job job(JobWithPoints(1));
  int made = 0;
  const auto make = [&] {
    ++made;
    JobSnapshot snapshot;
    snapshot.change = job.last_change();
    return snapshot;
  };
  const auto ever = std::chrono::hours(1);
  const auto never = std::chrono::milliseconds(0);
  const auto first = job.Snapshot(ever, make);
  EXPECT_EQ(job.Snapshot(never, make), first);  // nothing changed
  const uint64_t change = job.Add({.samples = 1});
  EXPECT_EQ(job.Snapshot(ever, make), first);  // young
  EXPECT_EQ(job.Snapshot(never, make)->change, change);
  EXPECT_EQ(made, 2);
}

class JobJournalTest : public testing::Test {
 protected:
  // Nothing is committed before it is flushed.
  void SetUp() override {
    ASSERT_OK_AND_ASSIGN(store_, Store::Open(folder_.File("store"),
                                             {.delay = kUnreachedLimit, .stall = kUnreachedLimit}));
    record_ = JobWithPoints(3);
    ASSERT_OK(store_->Commit([this](Database& database) { InsertJob(database, record_); }));
    job_ = std::make_shared<Job>(record_);
    journal_.emplace(job_, *store_, false, nullptr);
  }

  JobRecord Row() {
    return *ReadFrom(*store_, [this](Database& database) {
      return FindJob(database, record_.id, Grid::kIncluded);
    });
  }

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

TEST_F(JobJournalTest, AJobWithMissingResultsFails) {
  for (const size_t point : {0u, 2u}) Finish(point);
  job_->Add({.points_computed = 2.25});
  journal_->Ended(absl::OkStatus());
  ASSERT_OK(store_->Flush());
  const EnsembleJob job = Row().job;
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(), testing::HasSubstr("of 3 computed points the store keeps 2"));
  EXPECT_EQ(job.progress().fraction(), 2.25 / 3);  // as a watch has shown it before
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
                   [&](const JobRecord& ended) { ends.push_back(ended.job.state()); });
  for (const size_t point : {0u, 1u, 2u}) Finish(point);
  const uint64_t change = job_->last_state_change();
  journal_->Ended(absl::OkStatus());
  ASSERT_OK(store_->Flush());  // the rejected end
  ASSERT_OK(store_->Flush());
  const EnsembleJob job = Row().job;
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(), testing::HasSubstr("not this one"));
  EXPECT_EQ(job.progress().points_done(), 3);
  EXPECT_THAT(ends, testing::ElementsAre(EnsembleJob::FAILED));
  EXPECT_GT(job_->last_state_change(), change);
}

// A row has the number as a double, which damage may have changed to anything.
TEST_F(JobJournalTest, ADamagedNumberOfStoredBytesCountsAsZero) {
  for (const double damaged : {std::nan(""), 1e300, -1e300, -1.0}) {
    record_.job.set_stored_bytes(damaged);
    ASSERT_OK(store_->Commit([this](Database& database) { UpdateJob(database, record_); }));
    const auto principals = ReadFrom(*store_, &CountJobsByPrincipal);
    EXPECT_EQ(principals.at(0).stored_bytes(), 0) << damaged;
    EXPECT_EQ(Job(record_).Numbers().bytes, 0) << damaged;
  }
}

TEST(JobName, OnlyJobsAndResultsHaveTheirNames) {
  EXPECT_EQ(JobIdOf("ensembleJobs/0a-9"), "0a-9");
  EXPECT_EQ(ResultIdOf("ensembleJobs/a-1/results/7")->job, "a-1");
  EXPECT_EQ(ResultIdOf("ensembleJobs/a-1/results/4294967296")->point, 4'294'967'296);
  for (const std::string& name :
       std::vector<std::string>{"", "ensembleJobs/", "ensembleJobs/A", "ensembleJobs/a/b",
                                "ensembleJobs/" + std::string(64, 'a'), "a", "ensembleJobs/a b",
                                "ensembleJobs/a/results/", "ensembleJobs/a/results/-1",
                                "ensembleJobs/a/results/07", "ensembleJobs/A/results/7",
                                "results/7", "ensembleJobs/a/results/99999999999999999999"}) {
    EXPECT_EQ(JobIdOf(name), std::nullopt) << name;
    EXPECT_FALSE(ResultIdOf(name)) << name;
  }
}

}  // namespace
}  // namespace ballpiston::server
