#include <atomic>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
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

TEST(Restart, TheSameBytesWithATolerance) {
  v1::EnsembleSpec spec = Equilibrium(10, 0);
  spec.mutable_target()->set_tolerance(0.02);  // some 800 samples: neither one chunk nor all
  const std::vector<std::string> one = BytesAt(1, spec, FakeExperiments());
  v1::PointResult first;
  ASSERT_TRUE(first.ParseFromString(one.at(0)));
  EXPECT_GT(first.samples(), 64);
  EXPECT_LT(first.samples(), 1000 * kFakeSamplesPerBlock);
  EXPECT_EQ(BytesAt(2, spec, FakeExperiments()), one);
  EXPECT_EQ(BytesAt(8, spec, FakeExperiments()), one);
}

// The first process misses the tolerance at point 0. The second one ends the job as failed.
TEST(Restart, AToleranceMissedBeforeTheStopStaysMissed) {
  v1::EnsembleSpec spec = Equilibrium(2, 0);
  spec.mutable_target()->set_tolerance(1e-4);
  spec.mutable_target()->mutable_budget()->set_nanos(1);  // spent after a block
  TemporaryFolder folder;
  std::string name;
  {
    Gate gate;
    RunningServer server(
        InFolder(folder, 1, FakeExperiments([&gate](size_t point, uint64_t, std::stop_token stop) {
                   if (point == 1) gate.Pass(stop);
                 })));
    name = server.Submit(spec);
    gate.AwaitWaiting(1);
  }
  RunningServer server(InFolder(folder, 1));
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(),
              testing::HasSubstr("point 0: tolerance 0.0001 was not reached"));
  EXPECT_EQ(job.progress().points_done(), 2);
}

uint64_t HalfOf(const v1::EnsembleSpec& spec) {
  const v1::Target& target = spec.target();
  return static_cast<uint64_t>(target.has_samples() ? target.samples() : target.collisions()) / 2;
}

// The core's experiments, which wait after half of point 1.
ExperimentFactory StuckInTheMiddle(Gate& gate, const v1::EnsembleSpec& spec) {
  return HeldUpExperiments(
      [&gate, half = HalfOf(spec)](size_t point, uint64_t first, std::stop_token stop) {
        if (point > 1 || (point == 1 && first >= half)) gate.Pass(stop);
      });
}

TEST(Restart, AStoppedServerResumesToTheSameBytes) {
  for (const v1::EnsembleSpec& spec : AllExperiments()) {
    TemporaryFolder folder;
    std::string name;
    {
      Gate gate;
      RunningServer server(InFolder(folder, 2, StuckInTheMiddle(gate, spec)));
      name = server.Submit(spec);
      gate.AwaitWaiting(2);
    }
    std::atomic<int> of_point_0 = 0;
    std::atomic<uint64_t> first_of_point_1 = std::numeric_limits<uint64_t>::max();
    RunningServer server(
        InFolder(folder, 3, HeldUpExperiments([&](size_t point, uint64_t first, std::stop_token) {
                   of_point_0 += point == 0;
                   uint64_t seen = first_of_point_1;
                   while (point == 1 && first < seen &&
                          !first_of_point_1.compare_exchange_weak(seen, first)) {
                   }
                 })));
    EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(server.ResultBytes(name), BytesAt(2, spec));
    EXPECT_EQ(of_point_0, 0);                   // its result was stored
    EXPECT_GE(first_of_point_1, HalfOf(spec));  // and so was the first half
  }
}

// The copy has the files as they are at one moment, as after a kill or a power failure.
TEST(Restart, ACopyTakenInTheMiddleResumesToTheSameBytes) {
  TemporaryFolder folder, copy;
  const v1::EnsembleSpec spec = FirstHitByBilliard();
  std::string name;
  {
    Gate gate;
    RunningServer server(InFolder(folder, 2, StuckInTheMiddle(gate, spec)));
    name = server.Submit(spec);
    gate.AwaitWaiting(2);
    server.Submit(SmallEquilibrium());  // its commit takes along all that was recorded before
    for (const char* file : {"store.sqlite3", "store.sqlite3-wal"}) {
      std::filesystem::copy_file(folder.File(file), copy.File(file));
    }
  }
  RunningServer server(InFolder(copy, 8, nullptr));
  const EnsembleJob job = server.AwaitEnd(name);
  EXPECT_EQ(job.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(job.progress().samples(), 6 * 4096);
  EXPECT_EQ(server.ResultBytes(name), BytesAt(2, spec));
}

TEST(Restart, AnEndedJobStaysUnchanged) {
  TemporaryFolder folder;
  std::string name;
  EnsembleJob before;
  std::vector<std::string> bytes;
  {
    RunningServer server(InFolder(folder));
    name = server.Succeeded(Equilibrium(3, 5));
    before = server.Get(name);
    bytes = server.ResultBytes(name);
  }
  RunningServer server(InFolder(folder));
  EXPECT_EQ(server.Get(name).SerializeAsString(), before.SerializeAsString());
  EXPECT_EQ(server.ResultBytes(name), bytes);
}

TEST(Restart, ARequestIdIsRemembered) {
  TemporaryFolder folder;
  const auto request = CreateRequest(Equilibrium(1, 5), kUuid);
  EnsembleJob first;
  {
    RunningServer server(InFolder(folder));
    first = server.Created(request);
  }
  RunningServer server(InFolder(folder));
  const EnsembleJob again = server.Created(request);
  EXPECT_EQ(again.name(), first.name());
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

TEST(Restart, ACancellingJobBecomesCancelled) {
  TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  Change(folder, "UPDATE jobs SET state = 3");
  RunningServer server(InFolder(folder));
  const EnsembleJob job = server.Get(name);
  EXPECT_EQ(job.state(), EnsembleJob::CANCELLED);
  EXPECT_EQ(job.progress().points_done(), 1);
  EXPECT_EQ(server.ResultBytes(name).size(), 1u);
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

TEST(Restart, AJobThatCannotBeReadFails) {
  TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  Change(folder, "UPDATE jobs SET spec = x'ff'");
  RunningServer server(InFolder(folder));
  const EnsembleJob job = server.Get(name);
  EXPECT_EQ(job.state(), EnsembleJob::FAILED);
  EXPECT_THAT(job.error().message(), testing::HasSubstr("cannot be read"));
}

TEST(Restart, AJobWithADamagedCheckpointFailsAndTheServerStays) {
  TemporaryFolder folder;
  const std::string name = LeaveUnfinished(folder);
  Change(folder, "UPDATE checkpoints SET record = x'ff'");
  RunningServer server(InFolder(folder));
  EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::FAILED);
  server.Succeeded(Equilibrium(1, 5));
}

// One of the rows has a number of points that does not fit into memory.
TEST(Restart, AJobWithImpossibleRowsFailsAndTheServerStays) {
  for (const char* damage :
       {"UPDATE jobs SET points = -1", "UPDATE jobs SET points = 1 << 60",
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
