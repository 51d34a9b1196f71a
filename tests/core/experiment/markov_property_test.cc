#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/kernel.h"
#include "core/experiment/markov_property_statistics.h"
#include "core/statistics/group_scatter.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

// The energy below which a share v of the kernel lies, from the two forms of W's integral.
double EnergyAt(double v, double ep) {
  const double eb = 0.5 - ep, q = std::sqrt(std::fmax(eb - ep, 0));
  const double angle = ep < eb ? std::asin(std::sqrt(ep / eb)) : M_PI / 2;
  const double below = v * (std::sqrt(ep) * angle + q);
  if (below < std::sqrt(ep) * angle) return eb * std::pow(std::sin(below / std::sqrt(ep)), 2);
  return eb - std::pow(std::sqrt(ep) * angle + q - below, 2);
}

// Jumps after which an orbit's first energy is that of equilibrium.
constexpr size_t kBurnIn = 50;

// Draws v or the waiting time's exponent x from its previous value; v also depends on x.
using Draw = double (*)(CounterRandom& random, double before, double x);

double Uniform(CounterRandom& random, double, double) { return random.Uniform(); }
double Exponential(CounterRandom& random, double, double) { return -Log(random.Uniform()); }

BlockResult CountsOfProcess(uint64_t seed, int orbits, Draw outcome, Draw exponent) {
  BlockResult counts = EmptyMarkovPropertyCounts();
  for (int i = 0; i < orbits; ++i) {
    CounterRandom random(seed, 0, static_cast<uint64_t>(i));
    double energy = random.Uniform() / 2, v = 0.5, x = 1;
    for (size_t k = 0; k < kBurnIn; ++k) energy = EnergyAt(random.Uniform(), energy);
    std::vector<Exchange> exchanges(kExchangesPerOrbit);
    const double first = energy;
    for (Exchange& exchange : exchanges) {
      x = exponent(random, x, x);
      v = outcome(random, v, x);
      exchange.waiting_time = x / PairCollisionRate(energy);
      exchange.energy = energy = EnergyAt(v, energy);
    }
    CountOrbit(static_cast<uint64_t>(i), first, exchanges, counts);
  }
  return counts;
}

std::vector<Estimate> EstimatesOf(const BlockResult& counts, bool is_limit = false) {
  return EstimatesOf(MarkovPropertyTable(is_limit), counts);
}

// 4 standard errors for three correlations and two divergences, 6e-5 false alarms each; sqrt(N) D
// above 2.5 has a probability of 2 exp(-12.5) = 7e-6.
TEST(MarkovPropertyStatistics, JumpProcessHasNoMemory) {
  const BlockResult counts = CountsOfProcess(1, 20'000, Uniform, Exponential);
  ASSERT_EQ(counts.samples, 640'000u);
  const std::vector<Estimate> estimates = EstimatesOf(counts, true);
  ASSERT_EQ(estimates.size(), 6u);
  for (const Estimate& estimate : estimates) {
    if (estimate.name == "hitting_time_ks_distance") {
      EXPECT_LT(estimate.value, 2.5 / std::sqrt(640'000));
    } else {
      EXPECT_NEAR(estimate.value, estimate.noise_floor.value_or(0), 4 * *estimate.standard_error)
          << estimate.name;
    }
    EXPECT_NE(estimate.exact.has_value(), estimate.noise_floor.has_value()) << estimate.name;
  }
}

// Each kind of deviation shows in a different estimate.
TEST(MarkovPropertyStatistics, DetectsDeviationsFromMarkov) {
  struct Deviation {
    const char* estimate;
    Draw outcome, exponent;
    double expected, tolerance;
  };
  const Draw regular = [](CounterRandom& random, double, double) { return 0.5 + random.Uniform(); };
  const Draw lagging = [](CounterRandom& random, double before, double x) {
    return random.Uniform() < 0.5 ? before : Exponential(random, before, x);
  };
  const Draw hasty = [](CounterRandom&, double, double x) { return 1 - std::exp(-x); };
  const Draw high = [](CounterRandom& random, double, double) {  // density 2 v
    return std::sqrt(random.Uniform());
  };
  const Draw sluggish = [](CounterRandom& random, double before, double) {
    return random.Uniform() < 0.5 ? before : random.Uniform();
  };
  for (const Deviation& row :
       {Deviation{"hitting_time_ks_distance", Uniform, regular, 1 - std::exp(-0.5), 0.001},
        {"waiting_memory_correlation", Uniform, lagging, 0.5, 0.03},
        {"waiting_outcome_correlation", hasty, Exponential, 1, 0.02},
        {"transition_divergence", high, Exponential, std::log(2) - 0.5, 0.02}}) {
    const auto estimates = EstimatesOf(CountsOfProcess(2, 1000, row.outcome, row.exponent));
    EXPECT_NEAR(Named(row.estimate, estimates).value, row.expected, row.tolerance) << row.estimate;
  }
  const auto estimates = EstimatesOf(CountsOfProcess(6, 1000, sluggish, Exponential));
  const Estimate& memory = Named("memory_divergence", estimates);
  EXPECT_GT(memory.value, 20 * *memory.noise_floor);
  EXPECT_GT(std::fabs(Named("memory_correlation", estimates).value), 0.1);
}

// An orbit that alternates between two energies: the next energy is the previous one, so B = V.
TEST(MarkovPropertyStatistics, ReadBackwardIsTheLawReadForward) {
  BlockResult counts = EmptyMarkovPropertyCounts();
  for (uint64_t i = 0; i < 1000; ++i) {
    CounterRandom random(7, 0, i);
    const double here = random.Uniform() / 2, there = EnergyAt(random.Uniform(), here);
    std::vector<Exchange> exchanges(kExchangesPerOrbit, {.waiting_time = 1, .energy = there});
    for (size_t k = 1; k < exchanges.size(); k += 2) exchanges[k].energy = here;
    CountOrbit(i, here, exchanges, counts);
  }
  const std::vector<uint64_t> cells = CountsOf(std::span(counts.histograms).last(kGroups));
  for (size_t row = 0; row < kMemoryBins; ++row) {
    for (size_t bin = 0; bin < kMemoryBins; ++bin) {
      EXPECT_EQ(cells[row * kMemoryBins + bin] > 0, bin == row);
    }
  }
}

TEST(MarkovPropertyStatistics, EnergiesAtBothEndsAreCounted) {
  BlockResult counts = EmptyMarkovPropertyCounts();
  const std::vector<Exchange> exchanges = {{.waiting_time = 1e-300, .energy = 0.5},
                                           {.waiting_time = 1e300, .energy = 0},
                                           {.waiting_time = 0, .energy = 1e-300},
                                           {.waiting_time = 1, .energy = 0.25}};
  CountOrbit(0, 0, exchanges, counts);
  EXPECT_EQ(counts.samples, 4u);
  for (const Estimate& estimate : EstimatesOf(counts, true)) {
    EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
  }
}

TEST(MarkovProperty, CountsEveryCollisionOnce) {
  for (const Model model : {Model::kBilliard, Model::kBilliardReference, Model::kMarkov}) {
    for (const int64_t collisions : {1, 33, 40'000}) {
      const auto point = PointExperiment::Create(
          SpecOf(&kMarkovProperty, PaperPoint(0.2), {.collisions = collisions}, model), 0);
      const BlockResult merged = FoldPoint(*point);
      const PointSummary summary = point->Summarize(merged);
      EXPECT_EQ(summary.samples, static_cast<uint64_t>(collisions));
      EXPECT_EQ(merged.histograms[0].Total(), summary.samples);
      const bool has_memory = collisions > 1;
      for (const Estimate& estimate : summary.estimates) {
        const bool is_of_two = estimate.name.find("memory_correlation") != std::string::npos;
        EXPECT_EQ(std::isfinite(estimate.value), has_memory || !is_of_two) << estimate.name;
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
