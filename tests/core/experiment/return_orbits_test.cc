#include "core/experiment/return_orbits.h"

#include <gtest/gtest.h>

#include "tests/core/geometries.h"

namespace ballpiston {
namespace {

TEST(ReturnOrbits, AnEscapedOrbitCountsAsAnEscapeOnly) {
  ReturnOrbits orbits(kPaperPair, {0.125, 1}, {.seed = 1, .stream = 2}, {.samples = 2});
  Contact contact;
  contact.state = orbits.Start(0);
  orbits.Meet(0, contact);
  contact.escaped = true;
  orbits.Meet(1, contact);
  Health health;
  EXPECT_TRUE(Healthy(orbits.returns()[0], health));
  EXPECT_EQ(health.escapes, 0u);
  EXPECT_FALSE(Healthy(orbits.returns()[1], health));
  EXPECT_EQ(health.escapes, 1u);
}

}  // namespace
}  // namespace ballpiston
