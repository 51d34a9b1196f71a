#include "core/experiment/markov_property_divergence.h"

#include <cstddef>
#include <cstdint>

#include "core/geometry/elementary_functions.h"

namespace ballpiston {
namespace {

// The sum over the row's cells of n log(n/expected).
double Excess(const Histogram& row, double expected) {
  double sum = 0;
  for (const uint64_t count : row.counts) {
    const double n = static_cast<double>(count);
    if (count > 0) sum += n * Log(n / expected);
  }
  return sum;
}

KlDivergence Divergence(double excess, double samples, size_t free_cells) {
  return {.value = excess / samples,
          .noise_floor = static_cast<double>(free_cells) / (2 * samples),
          .cells = static_cast<int>(free_cells) + 1};
}

}  // namespace

KlDivergence DivergenceFromUniform(std::span<const Histogram> rows) {
  size_t cells = 0;
  double samples = 0, excess = 0;
  for (const Histogram& row : rows) {
    cells += row.counts.size();
    samples += static_cast<double>(row.Total());
  }
  for (const Histogram& row : rows) excess += Excess(row, samples / static_cast<double>(cells));
  return Divergence(excess, samples, cells - 1);
}

KlDivergence DivergenceWithinRows(std::span<const Histogram> rows) {
  size_t free_cells = 0;
  double samples = 0, excess = 0;
  for (const Histogram& row : rows) {
    const double in_row = static_cast<double>(row.Total());
    if (in_row == 0) continue;
    free_cells += row.counts.size() - 1;
    samples += in_row;
    excess += Excess(row, in_row / static_cast<double>(row.counts.size()));
  }
  return Divergence(excess, samples, free_cells);
}

}  // namespace ballpiston
