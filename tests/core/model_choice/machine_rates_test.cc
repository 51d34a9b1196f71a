#include "core/model_choice/machine_rates.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ballpiston {
namespace {

TEST(MachineRates, AreThoseOfTheEngine) {
  MachineRates rates;
  rates.lanes.wall_hit = 1, rates.lanes_single.wall_hit = 2, rates.reference.wall_hit = 3;
  EXPECT_EQ(rates.Of(Engine::kLanes).wall_hit, 1);
  EXPECT_EQ(rates.Of(Engine::kLanesSingle).wall_hit, 2);
  EXPECT_EQ(rates.Of(Engine::kReference).wall_hit, 3);
}

// How long they are is nobody's to say; that something was measured is.
TEST(MachineRates, AreMeasured) {
  const MachineRates rates = MeasureMachineRates();
  for (const double seconds : {rates.closed_form, rates.spectrum, rates.jump}) {
    EXPECT_GT(seconds, 0);
    EXPECT_TRUE(std::isfinite(seconds));
  }
  for (const EngineRate& engine : {rates.lanes, rates.lanes_single, rates.reference}) {
    EXPECT_GT(engine.wall_hit + engine.collision, 0);
    EXPECT_GT(engine.sample, 0);
    EXPECT_TRUE(std::isfinite(engine.wall_hit + engine.collision + engine.sample));
  }
}

}  // namespace
}  // namespace ballpiston
