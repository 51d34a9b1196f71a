#include "core/billiard/tangent_plane.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The growth of the two vectors over two equal waits with this map.
std::array<double, 2> GrowthWithExponent(double exponent) {
  const Collision collision = {
      .state = {.direction = {0.6, 0.8}, .ball_speed = 0.8, .piston_velocity = -0.6},
      .time = 50,
      .ball_wall_hits = 7,
      .piston_wall_hits = 2,
      .flights = {.aa = 0.9, .at = 0.2, .ta = 1.7, .tt = 0.4, .exponent = exponent}};
  TangentPlane plane;
  for (int wait = 0; wait < 2; ++wait) plane.Collide(collision);
  return plane.TakeGrowth();
}

// The second vector does not notice how much longer the first one is.
TEST(TangentPlane, LongWaitsNeedNoRangeOfExponents) {
  const auto long_wait = GrowthWithExponent(60), longest = GrowthWithExponent(1e6);
  EXPECT_NEAR(longest[0] - long_wait[0], 2 * (1e6 - 60) * std::numbers::ln2, 1e-9);
  EXPECT_NEAR(longest[1], long_wait[1], 1e-12);
}

}  // namespace
}  // namespace ballpiston
