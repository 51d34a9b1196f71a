// The flights of a device, computed by a processor here, give the bits of the lanes, also if the
// device fails. tests/benchmark/gpu_benchmark.cc compares a GPU.
#include "core/gpu/device_orbits.h"

#include "core/ensemble/point_fold.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/gpu/host_flights.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// ---- orbits ----

class OrbitsOf : public RecordedCollisions {
 public:
  OrbitsOf(const PairGeometry& geometry, uint64_t orbits, size_t collisions, OrbitDevice* device)
      : RecordedCollisions(geometry, orbits, collisions), device_(device) {}
  OrbitDevice* Device() const override { return device_; }

 private:
  OrbitDevice* device_;
};

struct DeviceRun {
  PairGeometry geometry = kPaperPair;
  uint64_t orbits = 300;
  size_t lanes = 64;
  HostFaults faults = {};
  std::vector<std::string> failures = {};  // that are reported
};

void ExpectBitsOfTheLanes(const DeviceRun& run) {
  constexpr size_t kCollisions = 4;
  std::vector<std::string> failures;
  OrbitsOnDevice device(
      std::make_unique<HostDevice>(run.lanes, run.faults), 1,
      [&](const absl::Status& status) { failures.emplace_back(status.message()); });
  OrbitsOf found(run.geometry, run.orbits, kCollisions, &device);
  EXPECT_TRUE(RunOrbits(Engine::kLanes, run.geometry, run.orbits, found));
  EXPECT_EQ(failures, run.failures);
  ForEachFusedTarget([&] {
    const RecordedCollisions lanes =
        Recorded(Engine::kLanes, run.geometry, run.orbits, kCollisions);
    for (uint64_t orbit = 0; orbit < run.orbits; ++orbit) {
      ASSERT_EQ(found.by_orbit()[orbit].size(), lanes.by_orbit()[orbit].size());
      for (size_t i = 0; i < lanes.by_orbit()[orbit].size(); ++i) {
        ExpectSameBits(lanes.by_orbit()[orbit][i], found.by_orbit()[orbit][i]);
      }
    }
  });
}

TEST(OrbitsOnDevice, HaveTheBitsOfTheLanes) {
  for (const double rho : {0.5 + 1e-9, 0.5 + 1e-4, 0.501, kPaperRho, 0.6, 0.7}) {
    for (const double share : {1.0, 0.5, 0.25}) {
      ExpectBitsOfTheLanes({.geometry = GeometryAtShare(rho, share), .orbits = 50});
    }
  }
  for (const size_t lanes : {1u, 7u, 500u}) ExpectBitsOfTheLanes({.lanes = lanes});
}

TEST(OrbitsOnDevice, GoOnAfterAFalseAlarm) {
  for (const double delta : {0.05, 0.2}) {
    ExpectBitsOfTheLanes({.geometry = PaperGeometry(delta), .faults = {.false_alarm = 1}});
  }
}

TEST(OrbitsOnDevice, GoOnInTheLanesWhenTheDeviceFails) {
  ExpectBitsOfTheLanes({.faults = {.make = 0}, .failures = {"memory full"}});
  for (const int call : {0, 5}) {
    ExpectBitsOfTheLanes({.faults = {.launch = call}, .failures = {"no launch"}});
    ExpectBitsOfTheLanes({.faults = {.land = call}, .failures = {"device lost"}});
  }
}

TEST(OrbitsOnDevice, AFailureIsReportedOnceAndNoLaterRunUsesTheDevice) {
  int failures = 0;
  OrbitsOnDevice device(std::make_unique<HostDevice>(64, HostFaults{.land = 0}), 1,
                        [&](const absl::Status&) { ++failures; });
  for (int run = 0; run < 3; ++run) {
    OrbitsOf source(kPaperPair, 100, 2, &device);
    EXPECT_TRUE(RunOrbits(Engine::kLanes, kPaperPair, 100, source));
    EXPECT_TRUE(device.has_failed());
  }
  EXPECT_EQ(failures, 1);
}

TEST(OrbitsOnDevice, AllRunsHaveUpToTwiceTheLanesOfTheDevice) {
  for (const size_t runs : {1u, 2u, 8u}) {
    OrbitsOnDevice device(std::make_unique<HostDevice>(64), runs, [](const absl::Status&) {});
    EXPECT_EQ(device.orbits(), runs == 1 ? 64u : 128u);
  }
}

// ---- experiments ----

class OneBlock : public BlockQueue {
 public:
  OneBlock(const Block& block, OrbitDevice& device) : block_(block), device_(device) {}

  std::optional<Block> Next() override { return std::exchange(block_, std::nullopt); }
  void Done(const Block&, BlockResult result) override { result_ = std::move(result); }
  bool Pause() override { return (++looks_ & 1) != 0; }
  OrbitDevice* device() const override { return &device_; }
  const BlockResult& result() const { return result_; }

 private:
  std::optional<Block> block_;
  OrbitDevice& device_;
  BlockResult result_;
  int looks_ = 0;
};

BlockResult BlockOnDevice(const PointExperiment& experiment, const Block& block) {
  OrbitsOnDevice device(std::make_unique<HostDevice>(64), 1, [](const absl::Status&) {});
  OneBlock queue(block, device);
  const std::unique_ptr<EngineRun> run = experiment.StartRun(queue);
  while (!run->Advance()) continue;
  return queue.result();
}

EnsembleSpec QuestionAt(const ExperimentKind* experiment, double delta, double epsilon) {
  std::optional<double> at_epsilon, exponent;
  if (experiment == &kConditionalMeanFreeTime || experiment == &kFirstHit) at_epsilon = epsilon;
  if (experiment == &kFirstHit) exponent = 2;
  return SpecOf(experiment, PaperPoint(delta, at_epsilon, exponent), {.samples = 1000},
                Model::kBilliard, 5);
}

void ExpectSameBlock(const EnsembleSpec& spec, uint64_t samples) {
  const auto experiment = PointExperiment::Create(spec, 0);
  const Block block = {.first = 700, .samples = samples};
  const BlockResult on_device = BlockOnDevice(*experiment, block);
  EXPECT_GT(on_device.samples, 0u);
  ForEachFusedTarget([&] { EXPECT_EQ(RunBlock(*experiment, block), on_device); });
}

TEST(OrbitsOnDevice, GiveTheBlocksOfTheLanes) {
  for (const double delta : {0.1, 0.2}) {
    ExpectSameBlock(QuestionAt(&kEquilibrium, delta, 0), 300);
    for (const double epsilon : {0.0, 0.125, 0.4, 0.5}) {  // at rest: the piston, the ball
      ExpectSameBlock(QuestionAt(&kConditionalMeanFreeTime, delta, epsilon), 200);
      ExpectSameBlock(QuestionAt(&kFirstHit, delta, epsilon), 200);
    }
    ExpectSameBlock(QuestionAt(&kMarkovProperty, delta, 0), 300);
  }
}

// Orbits of these expire at a time limit.
TEST(OrbitsOnDevice, ExpireAsInTheLanes) {
  ExpectSameBlock(QuestionAt(&kEnergyRelaxation, 0.2, 0), 100);
}

}  // namespace
}  // namespace ballpiston
