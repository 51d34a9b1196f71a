#include "core/statistics/told_error.h"

#include <gtest/gtest.h>

namespace ballpiston {
namespace {

TEST(ToldError, NeedsEvents) {
  EXPECT_EQ(ToldError(50, 1, 0.1), 0.1);
  EXPECT_FALSE(ToldError(49.9, 1, 0.1));
  EXPECT_FALSE(ToldError(1e6, 1, {}));
}

TEST(ToldError, IsAtLeastTheRoundingOfTheValue) {
  EXPECT_EQ(ToldError(64, -2, 0), 2 * kRoundingOfAMean);
  EXPECT_EQ(ToldError(64, 2, 1e-16), 2 * kRoundingOfAMean);
  EXPECT_EQ(ToldError(64, 2, 1e-13), 1e-13);
  EXPECT_EQ(ToldError(64, 0, 0), 0);
}

}  // namespace
}  // namespace ballpiston
