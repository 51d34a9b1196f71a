#include "core/statistics/cumulants.h"

#include <cmath>

namespace ballpiston {

double Cumulant(const Moments& sample, int order) {
  const auto count = static_cast<double>(sample.count);
  const double variance = sample.m2 / count;
  if (order == 2) return variance;
  return order == 3 ? sample.m3 / count : sample.m4 / count - 3 * variance * variance;
}

Jackknifed Jackknife(size_t groups, const std::function<double(size_t)>& without) {
  Moments left;
  for (size_t i = 0; i < groups; ++i) left.Add(without(i));
  const auto count = static_cast<double>(groups);
  return {.value = count * without(groups) - (count - 1) * left.mean,
          .error = std::sqrt((count - 1) / count * left.m2)};
}

}  // namespace ballpiston
