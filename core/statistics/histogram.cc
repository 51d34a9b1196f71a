#include "core/statistics/histogram.h"

#include <algorithm>
#include <numeric>

namespace ballpiston {

Histogram Histogram::OfBins(double lower, double upper, size_t bins) {
  return {.lower = lower, .upper = upper, .counts = std::vector<uint64_t>(bins)};
}

size_t Histogram::BinOf(double x) const {
  const double last = static_cast<double>(counts.size() - 1);
  const double position = (x - lower) / (upper - lower) * static_cast<double>(counts.size());
  return static_cast<size_t>(std::clamp(position, 0.0, last));
}

void Histogram::Merge(const Histogram& other) {
  for (size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
}

uint64_t Histogram::Total() const {
  return std::accumulate(counts.begin(), counts.end(), uint64_t{0});
}

double Histogram::Edge(size_t bin) const {
  const double share = static_cast<double>(bin) / static_cast<double>(counts.size());
  return lower * (1 - share) + upper * share;
}

}  // namespace ballpiston
