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

// The invariant law at fixed energies is its own ingoing law, so the transitions are those of the
// kernel at every delta: 4 standard errors of the noise, 6e-5 false alarms each. Distances from the
// exponential law fall as delta^2 times a logarithm: from step to step the ratio is that of delta^2
// within a factor of two. The smallest distance is 5 noise floors, so false alarms are negligible.
//
// The memory is well above the noise at delta = 0.3: by 29 standard errors with a million
// collisions, nightly by twice that. At each smaller delta it is less by more than 4 standard
// errors, as long as it is above the noise: 6e-5 false alarms each.
// 10 comparisons with the noise at most: one false alarm in 1600 choices of the seed.
TEST(MarkovProperty, HoldsInTheLimitOfSmallDelta) {
  const std::vector<Estimates> measured = Measured();
  const double least_signal = 20 * std::sqrt(static_cast<double>(Collisions()) / 1e6);
  for (const char* name : {"memory_divergence", "memory_correlation"}) {
    EXPECT_GT(Signal(measured[0].at(name)), least_signal) << name;
  }
  for (size_t i = 0; i < measured.size(); ++i) {
    SCOPED_TRACE(kDeltas[i]);
    EXPECT_LT(std::fabs(Signal(measured[i].at("transition_divergence"))), 4);
    if (i == 0) continue;
    const auto before = [&](const char* name) { return measured[i - 1].at(name); };
    const Estimate& distance = measured[i].at("hitting_time_ks_distance");
    const double expected =
        std::pow(kDeltas[i] / kDeltas[i - 1], 2) * before("hitting_time_ks_distance").value;
    EXPECT_LT(distance.value, 2 * expected);
    EXPECT_GT(distance.value, 0.5 * expected);
    EXPECT_GT(distance.value, 5 * *distance.noise_floor);
    for (const char* name : {"memory_divergence", "memory_correlation"}) {
      if (Signal(before(name)) < 10) continue;
      const Estimate& memory = measured[i].at(name);
      const double error = std::hypot(*before(name).standard_error, *memory.standard_error);
      EXPECT_LT(memory.value, before(name).value - 4 * error) << name;
    }
  }
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
