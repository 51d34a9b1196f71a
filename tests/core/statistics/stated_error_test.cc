#include "core/statistics/stated_error.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(StatedError, NeedsEvents) {
  EXPECT_EQ(StatedError(50, 1, 0.1), 0.1);
  EXPECT_FALSE(StatedError(49.9, 1, 0.1));
  EXPECT_FALSE(StatedError(1e6, 1, {}));
}

TEST(StatedError, IsAtLeastTheRoundingOfTheValue) {
  EXPECT_EQ(StatedError(64, -2, 0), 2 * kRoundingOfAMean);
  EXPECT_EQ(StatedError(64, 2, 1e-16), 2 * kRoundingOfAMean);
  EXPECT_EQ(StatedError(64, 2, 1e-13), 1e-13);
  EXPECT_EQ(StatedError(64, 0, 0), 0);
}

}  // namespace
}  // namespace ballpiston
