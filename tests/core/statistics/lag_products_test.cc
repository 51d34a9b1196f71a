#include "core/statistics/lag_products.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(LagProducts, OfAShortSeries) {
  const std::vector<double> products = LagProducts({1, 2, -3}, 2);
  EXPECT_EQ(products, (std::vector<double>{14.0 / 3, (2 - 6) / 2.0, -3}));
  EXPECT_EQ(IntegralsOf({4, 3, -1}), (std::vector<double>{2, 5, 4}));
}

}  // namespace
}  // namespace ballpiston
