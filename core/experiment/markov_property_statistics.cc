#include "core/experiment/markov_property_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/kernel.h"
#include "core/statistics/group_scatter.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/kolmogorov_smirnov.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

constexpr size_t kWaitingBinsOfAGroup = 32;

// The histograms of all groups, kind by kind, behind that of all waiting times.
enum Kind : size_t { kWaiting, kTransition, kMemories, kKinds };
constexpr size_t PlaceOf(Kind kind, size_t group) { return 1 + kind * kGroups + group; }
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

std::span<const Histogram> GroupsOf(Kind kind, const BlockResult& merged) {
  return std::span(merged.histograms).subspan(PlaceOf(kind, 0), kGroups);
}

// Adds x in [0, 1] to a row of cells.
void AddToRow(size_t row, size_t bins, double x, Histogram& cells) {
  ++cells.counts[row * bins + RowOf(x, bins)];
}

Reading CorrelationAt(Correlation correlation) {
  return [=](const BlockResult& merged) {
    const BatchMeans& measured = merged.batch_means[correlation];
    return RatioOf(measured, static_cast<double>(measured.batches()));
  };
}

// A distance between laws, whose error is that of orbits.
template <typename Distance>
Estimate DistanceOf(double value, const Distance& measured, const BlockResult& merged) {
  const auto orbits = static_cast<double>(merged.batch_means[kWaitingOutcome].batches());
  return {.value = value,
          .standard_error = StatedError(orbits, value, measured.standard_error),
          .batches = measured.batches,
          .noise_floor = measured.noise_floor};
}

std::optional<Estimate> HittingTimeDistance(const BlockResult& merged) {
  if (merged.samples == 0) return std::nullopt;
  const KolmogorovSmirnov measured =
      DistanceToUniform(merged.histograms[0], GroupsOf(kWaiting, merged));
  return DistanceOf(measured.distance, measured, merged);
}

// `has_counts`: the correlation whose terms are also counted in the rows.
Reading DivergenceAt(Kind kind, size_t rows, Correlation has_counts) {
  return [=](const BlockResult& merged) -> std::optional<Estimate> {
    if (merged.batch_means[has_counts].batches() == 0) return std::nullopt;
    const KlDivergence measured = DivergenceWithinRows(GroupsOf(kind, merged), rows);
    return DistanceOf(measured.value, measured, merged);
  };
}

}  // namespace

BlockResult EmptyMarkovPropertyCounts() {
  BlockResult counts;
  counts.batch_means.resize(kCorrelations);
  counts.histograms.push_back(Histogram::OfBins(0, 1, kWaitingBins));
  constexpr size_t kCells[kKinds] = {kWaitingBinsOfAGroup, kEnergyRows * kOutcomeBins,
                                     kMemoryBins * kMemoryBins};
  for (const size_t cells : kCells) {
    counts.histograms.resize(counts.histograms.size() + kGroups, Histogram::OfBins(0, 1, cells));
  }
  return counts;
}

void CountOrbit(uint64_t number, double energy, std::span<const Exchange> exchanges,
                BlockResult& counts) {
  const size_t group = number % kGroups;
  Histogram& transitions = counts.histograms[PlaceOf(kTransition, group)];
  Histogram& memories = counts.histograms[PlaceOf(kMemories, group)];
  ProductSum sums[kCorrelations];
  double energy_before = 0, waiting_before = 0;
  for (size_t k = 0; k < exchanges.size(); ++k) {
    const KernelDistribution law(energy);
    // T is counted in bins of 2^-10, so its relative accuracy near 0 does not matter.
    const double waiting = 1 - Exp(-law.CollisionRate() * exchanges[k].waiting_time);
    const double outcome = law.Below(exchanges[k].energy);
    counts.histograms[0].Add(waiting);
    counts.histograms[PlaceOf(kWaiting, group)].Add(waiting);
    AddToRow(RowOf(std::sqrt(2 * energy), kEnergyRows), kOutcomeBins, outcome, transitions);
    sums[kWaitingOutcome].Add(waiting, outcome);
    if (k > 0) {
      const double backward = law.Below(energy_before);
      AddToRow(RowOf(backward, kMemoryBins), kMemoryBins, outcome, memories);
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

std::vector<Measurement> MarkovPropertyTable(bool is_limit) {
  constexpr size_t kAllTogether = 1;
  const auto correlation = [&](const char* name, Correlation index) {
    return Measurement{.name = name,
                       .reading = CorrelationAt(index),
                       .exact = is_limit ? std::optional(0.0) : std::nullopt};
  };
  return {correlation("memory_correlation", kMemory),
          correlation("waiting_outcome_correlation", kWaitingOutcome),
          correlation("waiting_memory_correlation", kWaitingMemory),
          {"hitting_time_ks_distance", HittingTimeDistance},
          {"transition_divergence", DivergenceAt(kTransition, kEnergyRows, kWaitingOutcome)},
          {"memory_divergence", DivergenceAt(kMemories, kAllTogether, kMemory)}};
}

}  // namespace ballpiston
