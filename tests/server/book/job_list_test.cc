// The pages of a filtered list, over a store that is filled without a server.
#include "server/convert/timestamp.h"
#include "tests/server/book/book_test.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

struct StoredJob {
  std::string id;
  JobState state = EnsembleJob::SUCCEEDED;
  absl::Time create_time = absl::UnixEpoch();
  v1::EnsembleSpec spec = Equilibrium(1, 2);
};

class JobList : public BookTest {
 protected:
  // In the order of their creation.
  void Insert(const std::vector<StoredJob>& jobs) {
    ASSERT_OK(store_->Commit([&](Database& database) {
      for (const StoredJob& job : jobs) {
        JobRecord record;
        record.id = job.id;
        record.job.set_principal(kAnn.name);
        *record.job.mutable_spec() = job.spec;
        SetTime(job.create_time, record.job.mutable_create_time());
        InsertJob(database, record);
        record.job.set_state(job.state);
        UpdateJob(database, record);
      }
    }));
  }

  void InsertMany(int count, const StoredJob& job) {
    std::vector<StoredJob> jobs(static_cast<size_t>(count), job);
    for (size_t i = 0; i < jobs.size(); ++i) jobs[i].id += std::to_string(i);
    Insert(jobs);
  }

  static std::vector<std::string> IdsOf(const JobsPage& page) {
    std::vector<std::string> ids;
    for (const EnsembleJob& job : page.jobs) ids.push_back(JobIdOf(job.name()).value_or(""));
    return ids;
  }
};

TEST_F(JobList, AJobMatchesAllPartsOfTheFilter) {
  const absl::Time noon = absl::FromUnixSeconds(43'200);
  const absl::Time before = noon - absl::Nanoseconds(1);
  Insert({{"early", EnsembleJob::FAILED, before, SmallFirstHit()},
          {"match", EnsembleJob::FAILED, noon, SmallFirstHit()},
          {"experiment", EnsembleJob::FAILED, noon, Equilibrium(1, 2)},
          {"state", EnsembleJob::CANCELLED, noon, SmallFirstHit()}});
  const JobsQuery query = Query({.states = {EnsembleJob::FAILED, EnsembleJob::SUCCEEDED},
                                 .experiments = {v1::EnsembleSpec::FIRST_HIT},
                                 .since = noon});
  EXPECT_THAT(IdsOf(List(query)), ElementsAre("match"));
  EXPECT_EQ(List(query).next_before, std::nullopt);
  EXPECT_THAT(IdsOf(List(query, kBen)), IsEmpty());
}

// The clock was set back between two jobs: the list has the order of acceptance.
TEST_F(JobList, EveryJobSinceATimeIsListedIfTheClockWasSetBack) {
  const absl::Time since = absl::FromUnixSeconds(1000);
  Insert({{.id = "first", .create_time = since + absl::Hours(1)},
          {.id = "early", .create_time = since - absl::Hours(1)},
          {.id = "last", .create_time = since}});
  EXPECT_THAT(IdsOf(List(Query({.since = since}))), ElementsAre("last", "first"));
}

TEST_F(JobList, APageReadsABoundedNumberOfJobs) {
  Insert({{"match", EnsembleJob::FAILED}});
  InsertMany(kMaxJobsRead, {.id = "other"});
  JobsQuery query = Query({.states = {EnsembleJob::FAILED}});
  const JobsPage first = List(query);
  EXPECT_THAT(IdsOf(first), IsEmpty());
  ASSERT_NE(first.next_before, std::nullopt);
  query.before = *first.next_before;
  EXPECT_THAT(IdsOf(List(query)), ElementsAre("match"));
  EXPECT_EQ(List(query).next_before, std::nullopt);
}

TEST_F(JobList, APageReadsABoundedNumberOfBytes) {
  Insert({{"match", EnsembleJob::FAILED}});
  InsertMany(5, {.id = "large", .spec = LargeEquilibrium()});  // 720 kB each
  JobsQuery query = Query({.states = {EnsembleJob::FAILED}});
  query.max_bytes_read = size_t{2} << 20;
  std::vector<size_t> sizes;
  std::optional<int64_t> before = query.before;
  for (; before; before = List(query).next_before) {
    query.before = *before;
    sizes.push_back(List(query).jobs.size());
  }
  EXPECT_THAT(sizes, ElementsAre(0, 0, 1));
}

}  // namespace
}  // namespace ballpiston::server
