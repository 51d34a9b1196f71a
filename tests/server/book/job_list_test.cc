// The pages of a filtered list, over a store that is filled without a server.
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
        record.principal = kAnn.name;
        record.spec = SpecBytes(job.spec);
        record.state = job.state;
        record.create_time = job.create_time;
        InsertJob(database, record);
      }
    }));
  }

  JobsPage List(const JobsQuery& query, const Principal& caller = kAnn) {
    auto page = book_->List(caller, query);
    EXPECT_OK(page);
    return page.ok() ? *std::move(page) : JobsPage();
  }

  static JobsQuery Query(JobFilter filter = {}) {
    return {.filter = std::move(filter),
            .before = std::numeric_limits<int64_t>::max(),
            .max_jobs = 50,
            .max_bytes = std::numeric_limits<size_t>::max()};
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

// Jobs that do not match make no page short.
TEST_F(JobList, APageEndsAtItsNumberOfJobsAndBeforeItsBytes) {
  Insert({{"oldest", EnsembleJob::FAILED},
          {.id = "other"},
          {"older", EnsembleJob::FAILED, absl::UnixEpoch(), LargeEquilibrium()},  // 720 kB
          {.id = "large", .spec = LargeEquilibrium()},
          {"newest", EnsembleJob::FAILED}});
  const auto pages = [this](int max_jobs, size_t max_bytes) {
    JobsQuery query = Query({.states = {EnsembleJob::FAILED}});
    query.max_jobs = max_jobs;
    query.max_bytes = max_bytes;
    std::vector<std::vector<std::string>> ids;
    for (std::optional<int64_t> before = query.before; before;) {
      query.before = *before;
      const JobsPage page = List(query);
      ids.push_back(IdsOf(page));
      before = page.next_before;
    }
    return ids;
  };
  using Pages = std::vector<std::vector<std::string>>;
  EXPECT_EQ(pages(3, size_t{1} << 20), (Pages{{"newest", "older", "oldest"}}));
  EXPECT_EQ(pages(2, size_t{1} << 20), (Pages{{"newest", "older"}, {"oldest"}}));
  EXPECT_EQ(pages(3, 100'000), (Pages{{"newest"}, {"older"}, {"oldest"}}));
}

}  // namespace
}  // namespace ballpiston::server
