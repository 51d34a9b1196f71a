// A server with much in its store starts quickly, and lists it in little memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "client/library/client.h"
#include "core/geometry/paper.h"
#include "server/book/job_name.h"
#include "server/convert/spec.h"
#include "server/store/job_table.h"
#include "server/store/store.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::torture {
namespace {

using server::Database;
using server::JobRecord;
using server::Store;

constexpr double kMostSecondsToReady = 2;
constexpr int kGroup = 1'000;

// With unfinished jobs, one of ten is unfinished and of another engine, so that its results are
// dropped at the start.
enum class Unfinished { kNone, kSome };

void InsertJobs(Database& database, int count, const v1::EnsembleSpec& spec,
                Unfinished unfinished) {
  for (int i = 0; i < count; ++i) {
    const bool is_unfinished = unfinished == Unfinished::kSome && i % 10 == 0;
    JobRecord record;
    record.id = server::RandomId();
    record.spec = server::SpecBytes(spec);
    record.create_time = absl::Now();
    record.engine_version = is_unfinished ? "0.0.1" : server::EngineVersion();
    record.points = 1;
    server::InsertJob(database, record);
    server::InsertResult(database, record.sequence, {0, 10'000, std::string(300, 'r')});
    server::JobEnd end;
    end.time = absl::Now();
    end.numbers.points_done = 1;
    if (!is_unfinished) server::EndJob(database, record.sequence, end);
  }
}

void Fill(const std::string& path, int jobs, const v1::EnsembleSpec& spec, Unfinished unfinished) {
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(path, {.stall = kNever}));
  for (int i = 0; i < jobs; i += kGroup) {
    ASSERT_OK(store->Commit([&](Database& database) {
      InsertJobs(database, std::min(jobs - i, kGroup), spec, unfinished);
    }));
  }
}

// From the process's start to the answer of its first call.
double SecondsToFirstAnswer(ConnectedServer& server) {
  const auto start = std::chrono::steady_clock::now();
  server.Start();
  const client::Client client = server.NewClient();
  EXPECT_THAT(client.Get("ensembleJobs/" + server::RandomId()),
              StatusIs(absl::StatusCode::kNotFound));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(StartUp, IsQuickWithManyEndedAndUnfinishedJobs) {
  Findings findings("start-up");
  const int jobs = Size(2'000, 100'000);
  ConnectedServer server;
  SecondsToFirstAnswer(server);  // makes the store
  server.KillHard();
  const std::string path = server.data_dir() + "/store.sqlite3";
  Fill(path, jobs, ManyPoints(1, 10'000), Unfinished::kSome);
  findings.Count("jobs in the store", jobs);
  const double after_stop = SecondsToFirstAnswer(server);
  server.KillHard();
  const double after_kill = SecondsToFirstAnswer(server);
  if (HoldsToTimes()) {
    EXPECT_LT(after_stop, kMostSecondsToReady);
    EXPECT_LT(after_kill, kMostSecondsToReady);
  }
}

// A grid of 90,000 values of rho takes 720 kB. A BASIC view leaves it out.
TEST(Lists, InBasicViewOfLargeJobsTakeLittleMemory) {
  constexpr double kMostMiB = 32;
  Findings findings("lists of large jobs");
  const int jobs = Size(100, 500);
  ConnectedServer server;
  server.Start();
  server.KillHard();
  v1::EnsembleSpec spec = ManyPoints(1, 10'000);
  for (int i = 1; i < 90'000; ++i) spec.mutable_grid()->add_rho(kPaperRho);
  Fill(server.data_dir() + "/store.sqlite3", jobs, spec, Unfinished::kNone);
  server.Start();
  const double before = server.PeakMiB();
  std::vector<std::jthread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&, client = server.NewClient()] {
      v1::ListEnsembleJobsRequest request;
      request.set_view(v1::ListEnsembleJobsRequest::BASIC);
      findings.Count("jobs listed", static_cast<int64_t>(OrThrow(client.List(request)).size()));
    });
  }
  clients.clear();  // waits for them
  EXPECT_EQ(findings.count("jobs listed"), 8 * jobs);
  const double growth = server.PeakMiB() - before;
  EXPECT_LT(growth, kMostMiB);
}

}  // namespace
}  // namespace ballpiston::torture
