#include "server/jobs/job.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "server/jobs/job_name.h"
#include "server/jobs/job_state.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;

JobRecord Record(int64_t points = 4) {
  JobRecord record;
  record.sequence = 1;
  record.id = "a";
  record.points = points;
  return record;
}

Job::FinishedPoint Point(int index) {
  auto point = std::make_shared<v1::PointResult>();
  point->set_index(index);
  return point;
}

TEST(JobState, OnlyLegalTransitionsAreLegal) {
  const std::vector<std::pair<JobState, JobState>> legal = {
      {EnsembleJob::QUEUED, EnsembleJob::RUNNING},
      {EnsembleJob::QUEUED, EnsembleJob::CANCELLING},
      {EnsembleJob::QUEUED, EnsembleJob::SUCCEEDED},
      {EnsembleJob::QUEUED, EnsembleJob::FAILED},
      {EnsembleJob::RUNNING, EnsembleJob::CANCELLING},
      {EnsembleJob::RUNNING, EnsembleJob::SUCCEEDED},
      {EnsembleJob::RUNNING, EnsembleJob::FAILED},
      {EnsembleJob::CANCELLING, EnsembleJob::CANCELLED}};
  int found = 0;
  for (int from = 0; from <= EnsembleJob::CANCELLED; ++from) {
    for (int to = 0; to <= EnsembleJob::CANCELLED; ++to) {
      const std::pair<JobState, JobState> step{static_cast<JobState>(from),
                                               static_cast<JobState>(to)};
      const bool is_legal = std::find(legal.begin(), legal.end(), step) != legal.end();
      EXPECT_EQ(MayFollow(step.first, step.second), is_legal) << from << " -> " << to;
      found += is_legal;
    }
  }
  EXPECT_EQ(found, 8);
}

TEST(Job, AnIllegalTransitionChangesNothing) {
  int told = 0;
  Job job(Record(), [&] { ++told; });
  EXPECT_TRUE(job.Enter(EnsembleJob::CANCELLING, absl::Now()));
  EXPECT_FALSE(job.Enter(EnsembleJob::RUNNING, absl::Now()));
  EXPECT_EQ(job.state(), EnsembleJob::CANCELLING);
  EXPECT_FALSE(job.Message().has_start_time());
  EXPECT_EQ(told, 1);
}

TEST(Job, TimesAreThoseOfTheTransitions) {
  Job job(Record(), nullptr);
  job.Enter(EnsembleJob::RUNNING, absl::FromUnixSeconds(10));
  job.Enter(EnsembleJob::SUCCEEDED, absl::FromUnixSeconds(20));
  EXPECT_EQ(job.Message().start_time().seconds(), 10);
  EXPECT_EQ(job.Message().end_time().seconds(), 20);
}

TEST(Job, ProgressIsTheShareOfWorkDone) {
  Job job(Record(4), nullptr);
  job.AddRestoredPoints(1, 100, {});
  job.AddBlock(50, 0.5);
  const v1::JobProgress progress = job.Progress();
  EXPECT_EQ(progress.points(), 4);
  EXPECT_EQ(progress.points_done(), 1);
  EXPECT_EQ(progress.samples(), 150);
  EXPECT_EQ(progress.fraction(), 1.5 / 4);
}

TEST(Job, WithAToleranceThereIsNoFraction) {
  v1::EnsembleSpec spec;
  spec.mutable_target()->set_tolerance(0.1);
  JobRecord record = Record();
  record.spec = spec.SerializeAsString();
  EXPECT_FALSE(Job(record, nullptr).Progress().has_fraction());
}

TEST(Job, PointsFinishedSinceAreTheNewestFirst) {
  Job job(Record(1000), nullptr);
  uint64_t change = 0;
  for (int i = 0; i < 300; ++i) {
    const uint64_t number = job.AddFinishedPoint(Point(i));
    if (i == 290) change = number;
  }
  EXPECT_EQ(job.FinishedSince(0, 1000).size(), kRecentPoints);
  const auto since = job.FinishedSince(change, 1000);
  ASSERT_EQ(since.size(), 9u);
  EXPECT_EQ(since.front().point->index(), 299);
  EXPECT_EQ(since.back().point->index(), 291);
  EXPECT_EQ(job.FinishedSince(0, 3).size(), 3u);
  EXPECT_TRUE(job.FinishedSince(job.last_change(), 10).empty());
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
