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

  // A FAILED job, and then `count` jobs like `job`.
  void InsertMany(int count, const StoredJob& job) {
    std::vector<StoredJob> jobs(static_cast<size_t>(count), job);
    for (size_t i = 0; i < jobs.size(); ++i) jobs[i].id += std::to_string(i);
    Insert({{"match", EnsembleJob::FAILED}});
    Insert(jobs);
  }

  // The numbers of jobs on the pages of the list of FAILED jobs.
  std::vector<size_t> SizesOfPages() {
    JobsQuery query = Query({.states = {EnsembleJob::FAILED}});
    query.max_bytes_read = size_t{2} << 20;
    std::vector<size_t> sizes;
    for (std::optional<int64_t> before = query.before; before; before = List(query).next_before) {
      query.before = *before;
      sizes.push_back(List(query).jobs.size());
    }
    return sizes;
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
  Insert({{"match", EnsembleJob::FAILED, noon + absl::Hours(1), SmallFirstHit()},
          {"early", EnsembleJob::FAILED, before, SmallFirstHit()},  // the clock was set back
          {"later", EnsembleJob::FAILED, noon, SmallFirstHit()},
          {"experiment", EnsembleJob::FAILED, noon, Equilibrium(1, 2)},
          {"state", EnsembleJob::CANCELLED, noon, SmallFirstHit()}});
  const JobsQuery query = Query({.states = {EnsembleJob::FAILED, EnsembleJob::SUCCEEDED},
                                 .experiments = {v1::EnsembleSpec::FIRST_HIT},
                                 .since = noon});
  EXPECT_THAT(IdsOf(List(query)), ElementsAre("later", "match"));
  EXPECT_EQ(List(query).next_before, std::nullopt);
  EXPECT_THAT(IdsOf(List(query, kBen)), IsEmpty());
}

TEST_F(JobList, APageReadsABoundedNumberOfJobs) {
  InsertMany(kMaxJobsRead, {.id = "other"});
  EXPECT_THAT(SizesOfPages(), ElementsAre(0, 1));
}

TEST_F(JobList, APageReadsABoundedNumberOfBytes) {
  InsertMany(5, {.id = "large", .spec = LargeEquilibrium()});  // 720 kB each
  EXPECT_THAT(SizesOfPages(), ElementsAre(0, 0, 1));
}

}  // namespace
}  // namespace ballpiston::server
