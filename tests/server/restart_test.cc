#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/store_access.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;

// Options of a server on a folder that later servers use too.
TestServerOptions InFolder(const TemporaryFolder& folder, int workers = 2,
                           ExperimentFactory factory = FakeExperiments()) {
  return {.data_dir = folder.path(), .workers = workers, .factory = std::move(factory)};
}

// All these questions name the model, because a held-up experiment has no reason for its choice.
v1::EnsembleSpec FirstHitByBilliard() {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  return spec;
}

v1::EnsembleSpec SmallEquilibrium() {
  v1::EnsembleSpec spec = Equilibrium(3, 5000, 7);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  return spec;
}

v1::EnsembleSpec SmallMeanFreeTime() {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.set_experiment(v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_grid()->clear_exponent();
  return spec;
}

v1::EnsembleSpec SmallRelaxation(v1::EnsembleSpec::Model model) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.set_experiment(v1::EnsembleSpec::ENERGY_RELAXATION);
  spec.set_model(model);
  spec.mutable_grid()->clear_epsilon();
  spec.mutable_grid()->clear_exponent();
  spec.mutable_target()->set_samples(1024);
  return spec;
}

v1::EnsembleSpec SmallMarkovProperty() {
  v1::EnsembleSpec spec = SmallRelaxation(v1::EnsembleSpec::BILLIARD);
  spec.set_experiment(v1::EnsembleSpec::MARKOV_PROPERTY);
  spec.mutable_target()->set_collisions(8192);
  return spec;
}

v1::EnsembleSpec SmallGas(v1::EnsembleSpec::Experiment experiment, v1::EnsembleSpec::Model model) {
  v1::EnsembleSpec spec = SmallRelaxation(model);
  spec.set_experiment(experiment);
  spec.mutable_grid()->clear_delta();
  for (const double delta : {0.19, 0.17, 0.15}) spec.mutable_grid()->add_delta(delta);
  spec.mutable_grid()->add_cells("1");
  if (experiment == v1::EnsembleSpec::GAS_EQUILIBRIUM) {
    spec.mutable_grid()->add_temperature(2);
  } else {
    spec.mutable_grid()->add_hot(2);
    spec.mutable_grid()->add_cold(1);
  }
  // Two chunks of replicas, or four stages of trajectories, of which half a point has one and a
  // half.
  const bool is_steady = experiment == v1::EnsembleSpec::GAS_CONDUCTION;
  spec.mutable_target()->set_samples(is_steady ? 1000 : 96);
  return spec;
}

std::vector<v1::EnsembleSpec> AllExperiments() {
  return {FirstHitByBilliard(),
          SmallEquilibrium(),
          SmallMeanFreeTime(),
          SmallRelaxation(v1::EnsembleSpec::BILLIARD),
          SmallMarkovProperty(),
          SmallGas(v1::EnsembleSpec::GAS_EQUILIBRIUM, v1::EnsembleSpec::BILLIARD),
          SmallGas(v1::EnsembleSpec::GAS_CONDUCTION, v1::EnsembleSpec::BILLIARD)};
}

// The results of a server. If `factory` is null, it runs the core's experiments.
std::vector<std::string> BytesAt(int workers, const v1::EnsembleSpec& spec,
                                 ExperimentFactory factory = nullptr) {
  RunningServer server({.workers = workers, .factory = std::move(factory)});
  return server.ResultBytes(server.Succeeded(spec));
}

TEST(Restart, TheSameBytesAtOneTwoAndEightWorkers) {
  std::vector<v1::EnsembleSpec> specs = AllExperiments();
  specs.push_back(SmallFirstHit());  // AUTO, which gives a reason
  specs.push_back(SmallRelaxation(v1::EnsembleSpec::MARKOV));
  specs.push_back(SmallGas(v1::EnsembleSpec::GAS_EQUILIBRIUM, v1::EnsembleSpec::MARKOV));
  specs.push_back(SmallGas(v1::EnsembleSpec::GAS_CONDUCTION, v1::EnsembleSpec::MARKOV));
  for (const v1::EnsembleSpec& spec : specs) {
    const std::vector<std::string> one = BytesAt(1, spec);
    EXPECT_FALSE(one.empty());
    EXPECT_EQ(BytesAt(2, spec), one);
    EXPECT_EQ(BytesAt(8, spec), one);
  }
}

void Change(const TemporaryFolder& folder, const std::string& sql) {
  ChangeStore(folder.File("store.sqlite3"), sql);
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
  Change(folder,
         "UPDATE jobs SET engine_version = '0.0.1'; UPDATE results SET result = x'00';"
         "UPDATE checkpoints SET record = x'00'");
  std::atomic<int> computed = 0;
  RunningServer server(
      InFolder(folder, 2, FakeExperiments([&](size_t, uint64_t, std::stop_token) { ++computed; })));
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(job.engine_version(), EngineVersion());
  EXPECT_EQ(computed, 100);
  EXPECT_EQ(server.ResultBytes(name).size(), 2u);
}

// One of the rows has a number of points that does not fit into memory.
TEST(Restart, AJobWithDamagedOrImpossibleRowsFailsAndTheServerStays) {
  for (const char* damage :
       {"UPDATE jobs SET spec = x'ff'", "UPDATE checkpoints SET record = x'ff'",
        "UPDATE jobs SET points = -1", "UPDATE jobs SET points = 1 << 60",
        "UPDATE jobs SET points = 1", "UPDATE results SET point = 7",
        "UPDATE results SET point = -1", "UPDATE jobs SET points = -1, spec = x'ff'"}) {
    TemporaryFolder folder;
    const std::string name = LeaveUnfinished(folder);
    Change(folder, damage);
    RunningServer server(InFolder(folder));
    const EnsembleJob job = server.AwaitEnd(name);
    EXPECT_EQ(job.state(), EnsembleJob::FAILED) << damage;
    EXPECT_NE(job.error().message(), "") << damage;
    server.Succeeded(Equilibrium(1, 5));
  }
}

}  // namespace
}  // namespace ballpiston::server
