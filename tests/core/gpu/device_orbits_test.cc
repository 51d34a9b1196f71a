// The flights of a device, computed by a processor here, give the bits of the lanes, also if the
// device fails. tests/server/compute/thread_executor_test.cc compares whole experiments, on a GPU
// if there is one.
#include "core/gpu/device_orbits.h"

#include "tests/core/billiard/each_target.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/gpu/host_flights.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Orbits from equilibrium, and every eighth from a ball at rest within the piston's reach. Without
// a device the lanes of the processor compute them.
class OrbitsOf : public RecordedCollisions {
 public:
  OrbitsOf(const PairGeometry& geometry, uint64_t orbits, size_t collisions, OrbitDevice* device)
      : RecordedCollisions(geometry, orbits, collisions), geometry_(geometry), device_(device) {}
  PairState Start(uint64_t orbit) override {
    if (orbit % 8 != 0) return RecordedCollisions::Start(orbit);
    const double x = geometry_.piston_left() + 0.3 * geometry_.delta();
    return {.position = {x, 0}, .piston = 0.5, .piston_velocity = orbit % 16 == 0 ? 1.0 : -1.0};
  }
  OrbitDevice* Device() const override { return device_; }

 private:
  const PairGeometry geometry_;
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
  EXPECT_TRUE(found.Run(Engine::kLanes, run.geometry, run.orbits));
  EXPECT_EQ(failures, run.failures);
  ForEachFusedTarget([&] {
    OrbitsOf lanes(run.geometry, run.orbits, kCollisions, nullptr);
    EXPECT_TRUE(lanes.Run(Engine::kLanes, run.geometry, run.orbits));
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

TEST(OrbitsOnDevice, PauseEndsARun) {
  class Pauses : public OrbitsOf {
   public:
    using OrbitsOf::OrbitsOf;
    bool Pause() override { return true; }
  };
  OrbitsOnDevice device(std::make_unique<HostDevice>(64), 1, [](const absl::Status&) {});
  EXPECT_FALSE(Pauses(kPaperPair, 300, 4, &device).Run(Engine::kLanes, kPaperPair, 300));
}

TEST(OrbitsOnDevice, AFailureIsReportedOnceAndNoLaterRunUsesTheDevice) {
  int failures = 0;
  OrbitsOnDevice device(std::make_unique<HostDevice>(64, HostFaults{.land = 0}), 1,
                        [&](const absl::Status&) { ++failures; });
  for (int run = 0; run < 3; ++run) {
    OrbitsOf source(kPaperPair, 100, 2, &device);
    EXPECT_TRUE(source.Run(Engine::kLanes, kPaperPair, 100));
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

}  // namespace
}  // namespace ballpiston
