// A server with much in its store starts quickly, and lists it in little memory.
#include "core/engine_version.h"
#include "server/convert/spec.h"
#include "server/convert/timestamp.h"
#include "server/store/job_name.h"
#include "server/store/job_table.h"
#include "server/store/store.h"
#include "tests/fault/torture/questions.h"
#include "tools/flows/paper.h"

namespace ballpiston::torture {
namespace {

using server::Database;

constexpr double kMostSecondsToReady = 2;
constexpr int kGroup = 1'000;

// Ended jobs, with one result each, which is not read.
void InsertEnded(Database& database, int count, const v1::EnsembleSpec& spec) {
  for (int i = 0; i < count; ++i) {
    server::JobRecord record;
    record.id = server::RandomId();
    *record.job.mutable_spec() = spec;
    server::SetTime(absl::Now(), record.job.mutable_create_time());
    record.job.set_engine_version(EngineVersion());
    record.job.mutable_progress()->set_points(1);
    server::InsertJob(database, record);
    server::JobEnd end;
    end.time = absl::Now();
    end.numbers.points_done = 1;
    end.numbers.samples = 10'000;
    server::EndJob(database, record.sequence, end);
    server::InsertResult(database, record.sequence, {0, 10'000, std::string(300, 'r')});
  }
}

void Fill(const std::string& path, int jobs, const v1::EnsembleSpec& spec) {
  ASSERT_OK_AND_ASSIGN(const auto store, server::Store::Open(path, {.stall = kUnreachedLimit}));
  for (int i = 0; i < jobs; i += kGroup) {
    ASSERT_OK(store->Commit(
        [&](Database& database) { InsertEnded(database, std::min(jobs - i, kGroup), spec); }));
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

TEST(StartUp, IsQuickWithManyJobsInTheStore) {
  Findings findings("start-up");
  const int jobs = Size(2'000, 100'000);
  ConnectedServer server;
  server.Start();
  server.KillHard();
  Fill(server.data_dir() + "/store.sqlite3", jobs, ManyPoints(1, 10'000));
  findings.Count("jobs in the store", jobs);
  const double after_stop = SecondsToFirstAnswer(server);
  findings.Note("seconds to ready", absl::StrFormat("%.2f", after_stop));
  server.KillHard();
  const double after_kill = SecondsToFirstAnswer(server);
  findings.Note("seconds to ready after a kill", absl::StrFormat("%.2f", after_kill));
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
  Fill(server.data_dir() + "/store.sqlite3", jobs, spec);
  server.Start();
  const double before = server.PeakMiB();
  std::vector<std::jthread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&, client = server.NewClient()] {
      v1::ListEnsembleJobsRequest request;
      request.set_view(v1::ListEnsembleJobsRequest::BASIC);
      const auto jobs = client.List(request);
      ASSERT_OK(jobs);
      findings.Count("jobs listed", std::ssize(*jobs));
    });
  }
  clients.clear();  // waits for them
  EXPECT_EQ(findings.count("jobs listed"), 8 * jobs);
  const double growth = server.PeakMiB() - before;
  findings.Note("MiB of growth", absl::StrFormat("%.0f", growth));
  EXPECT_LT(growth, kMostMiB);
}

}  // namespace
}  // namespace ballpiston::torture
