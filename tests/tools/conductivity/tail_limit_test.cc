#include "tools/conductivity/tail_limit.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

std::vector<double> Sequence(const std::vector<double>& at, double power) {
  std::vector<double> values;
  for (const double n : at)
    values.push_back(7 + 2 * std::pow(n, -power) - 3 * std::pow(n, -power - 1));
  return values;
}

TEST(TailLimit, SequencesOfTheStatedFormHaveTheirLimit) {
  const std::vector<double> at = {8, 10, 12};
  for (const double power : {3.0, 6.0}) {
    EXPECT_NEAR(TailLimit(at, Sequence(at, power), power).value, 7, 1e-13);
  }
}

TEST(TailLimit, ErrorIsTheChangeByTheLastTerm) {
  const std::vector<double> at = {8, 10, 12};
  const std::vector<double> values = Sequence(at, 3);
  const ExtrapolatedValue all = TailLimit(at, values, 3);
  const double x = std::pow(10.0, -3), y = std::pow(12.0, -3);
  const double two = (values[1] * y - values[2] * x) / (y - x);
  EXPECT_NEAR(all.error, std::abs(two - all.value), 1e-13);
  EXPECT_GT(all.error, 1e-5);
}

}  // namespace
}  // namespace ballpiston
