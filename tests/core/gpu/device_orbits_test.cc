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

// Orbits that start in equilibrium. Every eighth orbit starts with a ball at rest within the
// piston's reach. Without a device the lanes of the processor compute the orbits.
OrbitOptions OrbitsOf(const PairGeometry& geometry, OrbitDevice* device) {
  const auto start = [geometry](uint64_t orbit) -> PairState {
    if (orbit % 8 != 0) return StartInEquilibrium(geometry, orbit);
    const double x = geometry.piston_left() + 0.3 * geometry.delta();
    return {.position = {x, 0}, .piston = 0.5, .piston_velocity = orbit % 16 == 0 ? 1.0 : -1.0};
  };
  return {.collisions = 4, .start = start, .device = device};
}

struct DeviceRun {
  PairGeometry geometry = kPaperPair;
  uint64_t orbits = 300;
  size_t lanes = 64;
  HostFaults faults = {};
  std::vector<std::string> failures = {};  // that are reported
};

void ExpectBitsOfTheLanes(const DeviceRun& run) {
  std::vector<std::string> failures;
  OrbitsOnDevice device(
      std::make_unique<HostDevice>(run.lanes, run.faults), 1,
      [&](const absl::Status& status) { failures.emplace_back(status.message()); });
  const auto found =
      Recorded(Engine::kLanes, run.geometry, run.orbits, OrbitsOf(run.geometry, &device));
  EXPECT_EQ(failures, run.failures);
  ForEachFusedTarget([&] {
    const auto lanes =
        Recorded(Engine::kLanes, run.geometry, run.orbits, OrbitsOf(run.geometry, nullptr));
    for (uint64_t orbit = 0; orbit < run.orbits; ++orbit) {
      ASSERT_EQ(found[orbit].size(), lanes[orbit].size());
      for (size_t i = 0; i < lanes[orbit].size(); ++i) {
        ExpectSameBits(lanes[orbit][i], found[orbit][i]);
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
  OrbitsOnDevice device(std::make_unique<HostDevice>(64), 1, [](const absl::Status&) {});
  OrbitOptions options = OrbitsOf(kPaperPair, &device);
  options.pause = [] { return true; };
  EXPECT_FALSE(RecordedCollisions(kPaperPair, 300, options).RunBy(Engine::kLanes));
}

TEST(OrbitsOnDevice, AFailureIsReportedOnceAndNoLaterRunUsesTheDevice) {
  int failures = 0;
  OrbitsOnDevice device(std::make_unique<HostDevice>(64, HostFaults{.land = 0}), 1,
                        [&](const absl::Status&) { ++failures; });
  for (int run = 0; run < 3; ++run) {
    Recorded(Engine::kLanes, kPaperPair, 100, OrbitsOf(kPaperPair, &device));
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
