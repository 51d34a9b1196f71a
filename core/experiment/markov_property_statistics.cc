#include "core/experiment/markov_property_statistics.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/kernel_distribution.h"
#include "core/experiment/sampled_estimate.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/kolmogorov_smirnov.h"

namespace ballpiston {
namespace {

// One exchange in five counts as an event for the error of the divergence within the rows by
// energy, because some rows have few: intervals of 95 % from 64 and 256 exchanges covered in 85 and
// 95 %.
constexpr double kEventsOfARow = 0.2;

constexpr size_t kFirstEnergyRow = 1;
constexpr size_t kFirstMemoryRow = kFirstEnergyRow + kEnergyRows;
enum Correlation : size_t { kMemory, kWaitingOutcome, kWaitingMemory, kCorrelations };

// The row of a number in [0, 1].
size_t RowOf(double x, size_t rows) {
  return std::min(static_cast<size_t>(x * static_cast<double>(rows)), rows - 1);
}

// 12 (x - 1/2)(y - 1/2) summed, with the number of terms.
struct ProductSum {
  double sum = 0;
  double terms = 0;

  void Add(double x, double y) {
    sum += 12 * (x - 0.5) * (y - 0.5);
    ++terms;
  }
};

std::span<const Histogram> EnergyRows(const BlockResult& merged) {
  return std::span(merged.histograms).subspan(kFirstEnergyRow, kEnergyRows);
}

std::span<const Histogram> MemoryRows(const BlockResult& merged) {
  return std::span(merged.histograms).subspan(kFirstMemoryRow, kMemoryBins);
}

Estimate CorrelationOf(std::string name, const BlockResult& merged, Correlation correlation,
                       std::optional<double> exact) {
  const BatchMeans& measured = merged.batch_means[correlation];
  Estimate estimate =
      SampledRatio(std::move(name), measured, static_cast<double>(measured.batches));
  estimate.exact = exact;
  return estimate;
}

Estimate HittingTimeDistance(const Histogram& waiting) {
  const KolmogorovSmirnov measured = DistanceToUniform(waiting);
  return {.name = "hitting_time_ks_distance",
          .value = measured.distance,
          .standard_error = measured.standard_error,
          .noise_floor = measured.noise_floor};
}

Estimate Divergence(std::string name, const KlDivergence& measured) {
  return {.name = std::move(name),
          .value = measured.value,
          .standard_error = measured.standard_error,
          .noise_floor = measured.noise_floor};
}

}  // namespace

BlockResult EmptyMarkovPropertyCounts() {
  BlockResult counts;
  counts.batch_means.resize(kCorrelations);
  counts.histograms.push_back(Histogram::OfBins(0, 1, kWaitingBins));
  counts.histograms.resize(kFirstMemoryRow, Histogram::OfBins(0, 1, kOutcomeBins));
  counts.histograms.resize(kFirstMemoryRow + kMemoryBins, Histogram::OfBins(0, 1, kMemoryBins));
  return counts;
}

void CountOrbit(double energy, std::span<const Exchange> exchanges, BlockResult& counts) {
  ProductSum sums[kCorrelations];
  double energy_before = 0, waiting_before = 0;
  for (size_t k = 0; k < exchanges.size(); ++k) {
    const auto law = KernelDistribution::OfPair(energy);
    // T is counted in bins of 2^-10, so its relative accuracy near 0 does not matter.
    const double waiting = 1 - Exp(-law.CollisionRate() * exchanges[k].waiting_time);
    const double outcome = law.Below(exchanges[k].energy);
    counts.histograms[0].Add(waiting);
    counts.histograms[kFirstEnergyRow + RowOf(std::sqrt(2 * energy), kEnergyRows)].Add(outcome);
    sums[kWaitingOutcome].Add(waiting, outcome);
    if (k > 0) {
      const double backward = law.Below(energy_before);
      counts.histograms[kFirstMemoryRow + RowOf(backward, kMemoryBins)].Add(outcome);
      sums[kMemory].Add(backward, outcome);
      sums[kWaitingMemory].Add(waiting_before, waiting);
    }
    energy_before = std::exchange(energy, exchanges[k].energy);
    waiting_before = waiting;
  }
  counts.samples += exchanges.size();
  for (size_t i = 0; i < kCorrelations; ++i) {
    if (sums[i].terms > 0) counts.batch_means[i].Add(sums[i].sum, sums[i].terms);
  }
}

std::vector<Estimate> MarkovPropertyEstimates(const BlockResult& merged,
                                              std::optional<double> exact_correlation) {
  std::vector<Estimate> estimates = {
      CorrelationOf("memory_correlation", merged, kMemory, exact_correlation),
      CorrelationOf("waiting_outcome_correlation", merged, kWaitingOutcome, exact_correlation),
      CorrelationOf("waiting_memory_correlation", merged, kWaitingMemory, exact_correlation)};
  if (merged.samples == 0) return estimates;
  estimates.push_back(HittingTimeDistance(merged.histograms[0]));
  estimates.push_back(
      Divergence("transition_divergence", DivergenceWithinRows(EnergyRows(merged))));
  if (!TellsItsError(kEventsOfARow * static_cast<double>(merged.samples))) {
    estimates.back().standard_error.reset();
  }
  if (merged.batch_means[kMemory].batches > 0) {
    estimates.push_back(Divergence("memory_divergence", DivergenceFromUniform(MemoryRows(merged))));
  }
  return estimates;
}

}  // namespace ballpiston
