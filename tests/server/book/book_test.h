// A book of jobs with its store and its threads: a server without gRPC, which a test can restart.
#pragma once

#include "server/book/job_book.h"
#include "server/store/job_name.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

inline const Principal kAnn{"ann", Role::kSubmit};
inline const Principal kBen{"ben", Role::kSubmit};
inline const Principal kRoot{"root", Role::kAdmin};

// Jobs with these seeds fail, or wait at the gate from point BookTest::held_from_ on.
inline constexpr uint64_t kFailingSeed = 1013, kHeldSeed = 1014;

class BookTest : public testing::Test {
 protected:
  BookTest() { Start(); }
  ~BookTest() override { Stop(); }

  // A new process of the server, on the same store.
  void Start(const Limits& limits = {}) {
    Stop();
    limits_ = limits;
    ASSERT_OK_AND_ASSIGN(store_, Store::Open(path_, {.delay = std::chrono::milliseconds(1),
                                                     .stall = kUnreachedLimit,
                                                     .reserve_bytes = 0}));
    pool_ = std::make_unique<ThreadPool>(
        2,
        FakeExperimentsBySeed([this](uint64_t seed, size_t point, uint64_t, std::stop_token stop) {
          if (seed == kFailingSeed) throw std::runtime_error("the ball left the cell");
          if (seed == kHeldSeed && point >= held_from_) gate_.Pass(stop);
        }));
    book_ = std::make_unique<JobBook>(*store_, limits_, pool_->scheduler());
    ASSERT_OK(book_->Resume());
  }

  void Stop() {
    book_.reset();
    pool_.reset();
    store_.reset();
  }

  absl::StatusOr<v1::EnsembleJob> Create(const Principal& caller,
                                         const v1::CreateEnsembleJobRequest& request) {
    return book_->Create(caller, request, CheckSpec(request.spec()));
  }

  // The id of the created or returned job.
  std::string Id(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const auto job = Create(caller, request);
    EXPECT_OK(job);
    return job.ok() ? *JobIdOf(job->name()) : "";
  }

  v1::EnsembleJob Get(const std::string& id) { return book_->Get(kRoot, id).value(); }

  v1::EnsembleJob::State AwaitEnd(const std::string& id) {
    AwaitThat([&] { return HasEnded(Get(id).state()); });
    return Get(id).state();
  }

  // Creates a job, waits for SUCCEEDED, and returns its id.
  std::string Answered(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const std::string id = Id(caller, request);
    EXPECT_EQ(AwaitEnd(id), v1::EnsembleJob::SUCCEEDED);
    return id;
  }

  static JobsQuery Query(JobFilter filter = {}) {
    return {.filter = std::move(filter),
            .before = std::numeric_limits<int64_t>::max(),
            .max_jobs = 50,
            .max_bytes = std::numeric_limits<size_t>::max()};
  }
  JobsPage List(const JobsQuery& query = Query(), const Principal& caller = kAnn) {
    return book_->List(caller, query).value();
  }

  Gate gate_;
  std::atomic<size_t> held_from_ = 0;
  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("store.sqlite3");
  Limits limits_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<JobBook> book_;
};

}  // namespace ballpiston::server
