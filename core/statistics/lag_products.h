// The autocorrelation of a series by lag, estimated from a part of it that has a known mean of 0.
#ifndef BALLPISTON_CORE_STATISTICS_LAG_PRODUCTS_H_
#define BALLPISTON_CORE_STATISTICS_LAG_PRODUCTS_H_

#include <cstddef>
#include <vector>

namespace ballpiston {

// At lags 0 to `most`, the mean of x_k x_(k + lag) over all k. Each is free of bias where the
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

// The integral of the autocorrelation over lags from 0 on, up to each lag: half of the first, and
// all of the others. Where the series holds integrals over steps of a continuous function, its
// autocorrelation counts fully up to that lag, and falls to 0 over one more step.
inline std::vector<double> IntegralsOf(const std::vector<double>& products) {
  std::vector<double> sums(products.size());
  double sum = -products[0] / 2;
  for (size_t lag = 0; lag < products.size(); ++lag) sums[lag] = sum += products[lag];
  return sums;
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_STATISTICS_LAG_PRODUCTS_H_
