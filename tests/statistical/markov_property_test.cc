// The Markov property of the billiard's energy exchanges, and the deviations from it at larger
// delta: every estimate of the experiment at delta = 0.3, 0.2, 0.1, 0.05.
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

using Estimates = std::map<std::string, Estimate>;

constexpr double kDeltas[] = {0.3, 0.2, 0.1, 0.05};

int64_t Collisions() { return IsNightly() ? 4'000'000 : 1'000'000; }

// The estimates at each delta of kDeltas, in the same order.
std::vector<Estimates> Measured() {
  std::vector<Estimates> measured;
  for (const double delta : kDeltas) {
    const EnsembleSpec spec = SpecOf(&kMarkovProperty, PaperPoint(delta),
                                     {.collisions = Collisions()}, Model::kBilliard, 30);
    Estimates& at = measured.emplace_back();
    for (const Estimate& estimate : RunPoint(spec).estimates) at[estimate.name] = estimate;
  }
  return measured;
}

// Distance above the noise floor, in standard errors.
double Signal(const Estimate& estimate) {
  return (estimate.value - estimate.noise_floor.value_or(0)) / *estimate.standard_error;
}

// This holds at every delta, because the invariant law at fixed energies is its own ingoing law: 4
// standard errors of the noise, 6e-5 false alarms each.
void ExpectTransitionsOfTheKernel(const std::vector<Estimates>& measured) {
  for (const Estimates& at : measured) {
    EXPECT_LT(std::fabs(Signal(at.at("transition_divergence"))), 4);
  }
}

// The distances fall as delta^2 times a logarithm: from step to step the ratio is that of delta^2
// within a factor of two. The smallest distance is 5 noise floors, so false alarms are negligible.
void ExpectHittingTimesToBecomeExponential(const std::vector<Estimates>& measured) {
  for (size_t i = 1; i < std::size(kDeltas); ++i) {
    const Estimate& before = measured[i - 1].at("hitting_time_ks_distance");
    const Estimate& here = measured[i].at("hitting_time_ks_distance");
    const double step = std::pow(kDeltas[i] / kDeltas[i - 1], 2);
    EXPECT_LT(here.value, 2 * step * before.value) << kDeltas[i];
    EXPECT_GT(here.value, 0.5 * step * before.value) << kDeltas[i];
    EXPECT_GT(here.value, 5 * *here.noise_floor) << kDeltas[i];
  }
}

// The memory is well above the noise at delta = 0.3: by 29 standard errors with a million
// collisions, nightly by twice that. At each smaller delta it is less by more than 4 standard
// errors, as long as it is above the noise: 6e-5 false alarms each.
void ExpectMemoryToFade(const std::vector<Estimates>& measured) {
  for (const char* name : {"memory_divergence", "memory_correlation"}) {
    EXPECT_GT(Signal(measured[0].at(name)), 20 * std::sqrt(static_cast<double>(Collisions()) / 1e6))
        << name;
    for (size_t i = 1; i < std::size(kDeltas); ++i) {
      const Estimate& before = measured[i - 1].at(name);
      const Estimate& here = measured[i].at(name);
      const double error = std::hypot(*before.standard_error, *here.standard_error);
      if (Signal(before) < 10) break;
      EXPECT_LT(here.value, before.value - 4 * error) << name << " at " << kDeltas[i];
    }
  }
}

// 10 comparisons with the noise at most: one false alarm in 1600 choices of the seed.
TEST(MarkovProperty, HoldsInTheLimitOfSmallDelta) {
  const std::vector<Estimates> measured = Measured();
  ExpectTransitionsOfTheKernel(measured);
  ExpectHittingTimesToBecomeExponential(measured);
  ExpectMemoryToFade(measured);
}

// In the tips of this cell a ball and a piston meet several times. The scatter of 100 seeds is
// known to 7 %, window 4 of these; errors of independent exchanges are 1.4 to 1.6 times too small,
// and the noise floor of the transitions is 1.35 times too low.
TEST(MarkovProperty, ErrorsHoldForCorrelatedExchanges) {
  const PointParameters point = {{kRho, 0.70528}, {kDelta, 0.00258}};
  std::map<std::string, Moments> values, variances, above_floor;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const EnsembleSpec spec =
        SpecOf(&kMarkovProperty, point, {.collisions = 6400}, Model::kBilliard, seed);
    for (const Estimate& estimate : RunPoint(spec).estimates) {
      values[estimate.name].Add(estimate.value);
      variances[estimate.name].Add(std::pow(*estimate.standard_error, 2));
      above_floor[estimate.name].Add(estimate.value - estimate.noise_floor.value_or(0));
    }
  }
  for (const auto& [name, measured] : values) {
    EXPECT_NEAR(std::sqrt(*measured.Variance() / variances[name].mean), 1, 0.28) << name;
  }
  const Moments& transitions = above_floor["transition_divergence"];
  EXPECT_NEAR(transitions.mean, 0, 4 * *transitions.StandardError());
}

}  // namespace
}  // namespace ballpiston
