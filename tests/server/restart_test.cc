
#include "tests/server/preamble.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

// Options of a server on a folder that later servers use too.
TestServerOptions InFolder(const TemporaryFolder& folder, int workers = 2,
                           ExperimentFactory factory = FakeExperiments()) {
  return {.data_dir = folder.path(), .workers = workers, .factory = std::move(factory)};
}

// The jobs use the real experiments of the core: each experiment with each model that samples.
TEST(Restart, TheSameBytesAtOneTwoAndEightWorkers) {
  std::vector<v1::EnsembleSpec> specs = {
      SmallFirstHit()};  // six points; AUTO, which gives a reason
  for (const EnsembleSpec& spec : EverySampledSpec()) specs.push_back(SpecMessage(spec));
  const auto bytes_at = [&](int workers) {
    RunningServer server({.workers = workers, .factory = nullptr});
    std::vector<std::vector<std::string>> bytes;
    for (const v1::EnsembleSpec& spec : specs) {
      bytes.push_back(server.ResultBytes(server.Succeeded(spec)));
    }
    return bytes;
  };
  const auto one = bytes_at(1), two = bytes_at(2), eight = bytes_at(8);
  for (size_t i = 0; i < specs.size(); ++i) {
    SCOPED_TRACE(specs[i].ShortDebugString());
    EXPECT_FALSE(one[i].empty());
    EXPECT_EQ(two[i], one[i]);
    EXPECT_EQ(eight[i], one[i]);
  }
}

TEST(Restart, WithLessMemoryOnlyNewJobsAreRefused) {
  const auto gas = FromText<v1::EnsembleSpec>(
      "experiment: GAS_EQUILIBRIUM grid { rho: 0.53 delta: 0.1 cells: '1000' } "
      "target { samples: 10 } model: BILLIARD");
  TemporaryFolder folder;
  TestServerOptions options = InFolder(folder);
  std::optional<RunningServer> server(options);
  const std::string name = server->Created(CreateRequest(gas, kUuid)).name();
  server->AwaitEnd(name);
  server.reset();
  options.limits.max_memory_mib = 1;
  server.emplace(options);
  EXPECT_EQ(server->Created(CreateRequest(gas, kUuid)).name(), name);  // a retry
  EXPECT_EQ(server->Created(CreateRequest(gas)).name(), name);         // a stored answer
  EXPECT_EQ(ReasonOf(server->Create(FreshRequest(gas))), "INVALID_SPEC");
}

// A job of the fake experiments, stopped with a finished point and a part of the second.
std::string LeaveUnfinished(const TemporaryFolder& folder) {
  Gate gate;
  RunningServer server(
      InFolder(folder, 2, FakeExperiments([&](size_t point, uint64_t block, std::stop_token stop) {
                 if (point == 1 && block >= 10) gate.Pass(stop);
               })));
  const std::string name = server.Submit(Equilibrium(2, 50));
  gate.AwaitWaiting(2);
  return name;
}

TEST(Restart, AnotherEngineComputesAllAgain) {
  TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  const std::string store = folder.File("store.sqlite3");
  ChangeStore(store, "UPDATE results SET result = x'00'; UPDATE checkpoints SET record = x'00'");
  ChangeJobs(store, [](EnsembleJob& job) { job.set_engine_version("0.0.1"); });
  std::atomic<int> computed = 0;
  RunningServer server(
      InFolder(folder, 2, FakeExperiments([&](size_t, uint64_t, std::stop_token) { ++computed; })));
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(job.engine_version(), EngineVersion());
  EXPECT_EQ(computed, 100);
  EXPECT_EQ(server.ResultBytes(name).size(), 2u);
}

// `damage` changes the file of a store with an unfinished job.
void ExpectThatTheJobFailsAndTheServerStays(
    const std::function<void(const std::string& store)>& damage) {
  const TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  damage(folder.File("store.sqlite3"));
  RunningServer server(InFolder(folder));
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.name(), name);
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_NE(job.error().message(), "");
  server.Succeeded(Equilibrium(1, 5));
}

TEST(Restart, AJobWithDamagedRowsFailsAndTheServerStays) {
  for (const char* damage :
       {"UPDATE jobs SET message = x'ff'", "UPDATE jobs SET grid = x'ff'",
        "UPDATE jobs SET message = x''", "UPDATE checkpoints SET record = x'ff'",
        "UPDATE results SET point = 7", "UPDATE results SET point = -1"}) {
    SCOPED_TRACE(damage);
    ExpectThatTheJobFailsAndTheServerStays(
        [damage](const std::string& store) { ChangeStore(store, damage); });
  }
}

TEST(Restart, AJobWithAnImpossibleNumberOfPointsFailsAndTheServerStays) {
  for (const int32_t points : {-1, 1, std::numeric_limits<int32_t>::max()}) {
    SCOPED_TRACE(points);
    ExpectThatTheJobFailsAndTheServerStays([points](const std::string& store) {
      ChangeJobs(store, [points](EnsembleJob& job) { job.mutable_progress()->set_points(points); });
    });
  }
}

}  // namespace
}  // namespace ballpiston::server
