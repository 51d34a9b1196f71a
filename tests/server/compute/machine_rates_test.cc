#include "server/compute/machine_rates.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ballpiston::server {
namespace {

// The test asserts no particular rate: it depends on the machine.
TEST(MachineRates, AreMeasured) {
  const MachineRates rates = MeasureSamplingRates();
  EXPECT_GT(rates.jump, 0);
  for (const EngineRate& engine : {rates.lanes, rates.lanes_single, rates.reference}) {
    EXPECT_GT(engine.wall_hit + engine.collision, 0);
    EXPECT_GT(engine.sample, 0);
    EXPECT_GE(engine.lanes, 1);
    EXPECT_TRUE(std::isfinite(engine.wall_hit + engine.collision + engine.sample));
  }
  EXPECT_EQ(rates.reference.lanes, 1);
  EXPECT_GE(rates.lanes.lanes, 6);  // six vectors
}

}  // namespace
}  // namespace ballpiston::server
