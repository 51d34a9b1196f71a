
#include "tests/server/preamble.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

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
  const auto one = bytes_at(1);
  EXPECT_THAT(one, Each(Not(IsEmpty())));
  for (const int workers : {2, 8}) {
    const auto more = bytes_at(workers);
    for (size_t i = 0; i < specs.size(); ++i) {
      EXPECT_EQ(more[i], one[i]) << workers << " workers: " << specs[i].ShortDebugString();
    }
  }
}

TEST(Restart, WithLessMemoryOnlyNewJobsAreRefused) {
  const auto gas = FromText<v1::EnsembleSpec>(
      "experiment: GAS_EQUILIBRIUM grid { rho: 0.53 delta: 0.1 cells: '1000' } "
      "target { samples: 10 } model: BILLIARD");
  TemporaryFolder folder;
  TestServerOptions options = {.data_dir = folder.path()};
  std::optional<RunningServer> server(options);
  const std::string name = server->Created(CreateRequest(gas, kUuid)).name();
  server->AwaitEnd(name);
  server.reset();
  options.limits.max_memory_mib = 1;
  server.emplace(options);
  EXPECT_EQ(server->Created(CreateRequest(gas, kUuid)).name(), name);  // a retry
  EXPECT_EQ(server->Created(CreateRequest(gas)).name(), name);         // a stored answer
  EXPECT_EQ(ReasonOf(server->Call(FreshRequest(gas))), "INVALID_SPEC");
}

// A job of the fake experiments, stopped with a finished point and a part of the second.
std::string LeaveUnfinished(const TemporaryFolder& folder,
                            const v1::EnsembleSpec& spec = Equilibrium(2, 50)) {
  Gate gate;
  RunningServer server(
      {.data_dir = folder.path(),
       .factory = FakeExperiments([&](size_t point, uint64_t block, std::stop_token stop) {
         if (point == 1 && block >= 10) gate.Pass(stop);
       })});
  const std::string name = server.Submit(spec);
  gate.AwaitWaiting(2);
  return name;
}

// Both points miss the tolerance. The error names the first point, which ended before the restart,
// even if it has too few samples for an estimate.
TEST(Restart, AMissedToleranceIsRemembered) {
  v1::EnsembleSpec spec = Equilibrium(2, 50);
  spec.mutable_target()->set_tolerance(1e-6);  // replaces the number of collisions
  for (const char* change : {"SELECT 0", "UPDATE results SET samples = 0, result = x''"}) {
    SCOPED_TRACE(change);
    const TemporaryFolder folder;
    const std::string name = LeaveUnfinished(folder, spec);
    ChangeStore(folder.File("store.sqlite3"), change);
    RunningServer server({.data_dir = folder.path()});
    const EnsembleJob job = server.AwaitEnd(name);
    EXPECT_THAT(job.error().message(), HasSubstr("point 0"));
  }
}

TEST(Restart, AnotherEngineComputesAllAgain) {
  TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  const std::string store = folder.File("store.sqlite3");
  ChangeStore(store, "UPDATE results SET result = x'00'; UPDATE checkpoints SET record = x'00'");
  ChangeJob(store, name, [](EnsembleJob& job) { job.set_engine_version("0.0.1"); });
  std::atomic<int> computed = 0;
  RunningServer server(
      {.data_dir = folder.path(),
       .factory = FakeExperiments([&](size_t, uint64_t, std::stop_token) { ++computed; })});
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(job.engine_version(), EngineVersion());
  EXPECT_EQ(computed, 100);
  EXPECT_EQ(server.ResultBytes(name).size(), 2u);
}

TEST(Restart, AJobWithDamagedRowsFailsAndTheServerStays) {
  using Damage = std::function<void(const std::string& store, const std::string& job)>;
  std::map<std::string, Damage> damages;
  for (const char* sql : {"UPDATE jobs SET message = x'ff'", "UPDATE jobs SET grid = x'ff'",
                          "UPDATE jobs SET message = x''", "UPDATE checkpoints SET record = x'ff'",
                          "UPDATE results SET point = 7", "UPDATE results SET point = -1"}) {
    damages[sql] = [sql](const std::string& store, auto) { ChangeStore(store, sql); };
  }
  for (const int32_t points : {-1, 1, std::numeric_limits<int32_t>::max()}) {
    damages[absl::StrCat(points, " points")] = [points](const std::string& store,
                                                        const std::string& job) {
      ChangeJob(store, job, [&](EnsembleJob& of) { of.mutable_progress()->set_points(points); });
    };
  }
  for (const auto& [text, damage] : damages) {
    SCOPED_TRACE(text);
    const TemporaryFolder folder;
    const std::string name = LeaveUnfinished(folder);
    damage(folder.File("store.sqlite3"), name);
    RunningServer server({.data_dir = folder.path()});
    const EnsembleJob job = server.AwaitEnd(name);
    EXPECT_EQ(job.name(), name);
    EXPECT_EQ(job.state(), EnsembleJob::FAILED);
    EXPECT_EQ(job.progress().points_done(), 1);  // the second point is not computed
    EXPECT_NE(job.error().message(), "");
    server.Succeeded(Equilibrium(1, 5));
  }
}

}  // namespace
}  // namespace ballpiston::server
