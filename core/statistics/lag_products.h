// The autocorrelation by lag of a series with mean 0.
#pragma once

#include <cstddef>
#include <vector>

namespace ballpiston {

// The mean of x_k x_(k + lag) over all k, for lags 0 to `most`. The means have no bias if the
// series is stationary. Requires most < series.size().
inline std::vector<double> LagProducts(const std::vector<double>& series, size_t most) {
  std::vector<double> means(most + 1);
  for (size_t lag = 0; lag <= most; ++lag) {
    double sum = 0;
    for (size_t k = 0; k + lag < series.size(); ++k) sum += series[k] * series[k + lag];
    means[lag] = sum / static_cast<double>(series.size() - lag);
  }
  return means;
}

// The integral of the autocorrelation from lag 0 to each lag: half of the first product plus all
// the others. If the series holds integrals of a continuous function over steps, the function's
// autocorrelation counts fully up to the lag, and its weight falls to 0 over one more step.
inline std::vector<double> IntegralsOf(const std::vector<double>& products) {
  std::vector<double> sums(products.size());
  double sum = -products[0] / 2;
  for (size_t lag = 0; lag < products.size(); ++lag) sums[lag] = sum += products[lag];
  return sums;
}

}  // namespace ballpiston
