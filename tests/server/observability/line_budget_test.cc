#include "server/observability/line_budget.h"

#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;

TEST(LineBudget, LinesOverTheBudgetAreLeftOutAndCountedWithTheNext) {
  LineBudget budget(3, milliseconds(1000));
  const LineBudget::Clock::time_point begin{milliseconds(5000)};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(budget.Take(begin + milliseconds(i)), 0);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(budget.Take(begin + milliseconds(999)), std::nullopt);
  EXPECT_EQ(budget.Take(begin + milliseconds(1000)), 7);
  EXPECT_EQ(budget.Take(begin + milliseconds(1001)), 0);
}

TEST(LineBudget, LinesWithinTheBudgetAreAllWritten) {
  LineBudget budget(2, milliseconds(1000));
  LineBudget::Clock::time_point now{milliseconds(1)};
  for (int i = 0; i < 100; ++i, now += milliseconds(500)) EXPECT_EQ(budget.Take(now), 0);
}

}  // namespace
}  // namespace ballpiston::server
