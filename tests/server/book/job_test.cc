#include "server/book/job.h"

#include "tests/server/book/book_test.h"
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

// ---- the end of a job, and damage ----

class JobInStore : public BookTest {
 protected:
  // A job of three points at its end. The store rejects the writes that fit `event`.
  EnsembleJob EndedWithout(const std::string& event) {
    EXPECT_OK(store_->Commit([&](Database& database) {
      database.Execute("CREATE TRIGGER rejection BEFORE " + event +
                       " BEGIN SELECT RAISE(ABORT, 'not this one'); END");
    }));
    const std::string id = Id(kAnn, CreateRequest(Equilibrium(3, 1)));
    EXPECT_EQ(AwaitEnd(id), EnsembleJob::FAILED);
    return Get(id);
  }
};

TEST_F(JobInStore, AJobWithMissingResultsFails) {
  const EnsembleJob job = EndedWithout("INSERT ON results WHEN new.point = 1");
  EXPECT_THAT(job.error().message(), HasSubstr("of 3 computed points the store keeps 2"));
  EXPECT_EQ(job.progress().points_done(), 2);
  EXPECT_EQ(job.progress().fraction(), 1);  // as a watch has shown it before
}

// Otherwise the job would be active until the next start of the server.
TEST_F(JobInStore, AJobWhoseEndTheStoreRejectsFails) {
  const EnsembleJob job = EndedWithout("UPDATE ON jobs WHEN new.state = 4");
  EXPECT_THAT(job.error().message(), HasSubstr("not this one"));
  EXPECT_EQ(job.progress().points_done(), 3);
  AwaitThat([this] { return book_->ended_jobs().at(EnsembleJob::FAILED) == 1; });
  EXPECT_EQ(book_->ended_jobs().at(EnsembleJob::SUCCEEDED), 0);
}

// A row has the number as a double, which damage may have changed to anything.
TEST_F(JobInStore, ADamagedNumberOfStoredBytesCountsAsZero) {
  JobRecord record = JobWithPoints(3);
  ASSERT_OK(store_->Commit([&](Database& database) { InsertJob(database, record); }));
  for (const double damaged : {std::nan(""), 1e300, -1e300, -1.0}) {
    record.job.set_stored_bytes(damaged);
    ASSERT_OK(store_->Commit([&](Database& database) { UpdateJob(database, record); }));
    const auto principals = ReadFrom(*store_, &CountJobsByPrincipal);
    EXPECT_EQ(principals.at(0).stored_bytes(), 0) << damaged;
    EXPECT_EQ(Job(record).Numbers().bytes, 0) << damaged;
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
