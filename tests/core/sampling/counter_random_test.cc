#include "core/sampling/counter_random.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The published known-answer vector of Philox4x64-10 for key and counter zero.
TEST(CounterRandom, IsPhilox4x64) {
  CounterRandom random(0, 0, 0);
  EXPECT_EQ(random.Bits(), 0x16554d9eca36314cu);
  EXPECT_EQ(random.Bits(), 0xdb20fe9d672d0fdcu);
  EXPECT_EQ(random.Bits(), 0xd7e772cee186176bu);
  EXPECT_EQ(random.Bits(), 0x7e68b68aec7ba23bu);
}

}  // namespace
}  // namespace ballpiston
