#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec AskedAt(double rho, double delta, int64_t collisions, Model model) {
  return SpecOf(&kLyapunov, {{kRho, rho}, {kDelta, delta}}, {.collisions = collisions}, model);
}

struct Reference {
  double delta;
  double first, first_error;
  double second, second_error;
};

// By an independent plain program, 32 runs of 3e5 events each, at rho = 0.53.
constexpr Reference kReferences[] = {{0.3, 3.118, 0.002, 0.3523, 0.0005},
                                     {0.2, 3.195, 0.003, 0.2018, 0.0005},
                                     {0.1, 3.266, 0.004, 0.0790, 0.0004}};

void ExpectNear(const Estimate& estimate, double value, double error) {
  const double z = (estimate.value - value) / std::hypot(*estimate.standard_error, error);
  EXPECT_LT(std::fabs(z), 4) << estimate.name;
}

// False alarms: 6e-5 for each of the 36 numbers.
TEST(Lyapunov, EveryEngineHasTheExponentsOfAnotherProgram) {
  for (const auto& [model, precision, collisions] :
       {std::tuple(Model::kBilliard, Precision::kDouble, 200'000),
        {Model::kBilliard, Precision::kSingle, 50'000},
        {Model::kBilliardReference, Precision::kDouble, 10'000}}) {
    for (const Reference& reference : kReferences) {
      EnsembleSpec spec = AskedAt(0.53, reference.delta, collisions, model);
      spec.precision = precision;
      const PointSummary summary = RunPoint(spec);
      ExpectNear(Named("lyapunov_1", summary.estimates), reference.first, reference.first_error);
      ExpectNear(Named("lyapunov_2", summary.estimates), reference.second, reference.second_error);
      ExpectNear(Named("entropy", summary.estimates), reference.first + reference.second,
                 reference.first_error);
      const Estimate& time = Named("mean_free_time_ball_piston", summary.estimates);
      EXPECT_LT(std::fabs(*time.ZScore()), 4);
      EXPECT_EQ(summary.health.escapes, 0u);
    }
  }
}

TEST(Lyapunov, ExponentsOfACollisionAreThoseOfItsTime) {
  const PointSummary summary = RunPoint(AskedAt(0.6, 0.05, 10'000, Model::kBilliard));
  const double time = Named("mean_free_time_ball_piston", summary.estimates).value;
  for (const std::string name : {"lyapunov_1", "lyapunov_2"}) {
    EXPECT_NEAR(Named(name + "_per_collision", summary.estimates).value,
                time * Named(name, summary.estimates).value, 1e-12 * time * 20);
  }
}

// lambda_k = -lambda_(7-k). Rounding costs the smallest vector the most digits. Where the true
// value is 0, rounding is a bias that a scatter does not show, and the stated error is larger.
TEST(PairTangents, ExponentsComeInPairs) {
  for (const double rho : {0.501, 0.53, 0.7}) {
    const double delta = 0.9 * PairDeltaBound(rho);
    const PointSummary summary = RunPoint(AskedAt(rho, delta, 3200, Model::kBilliardReference));
    const auto exponent = [&](int k) {
      return Named("lyapunov_" + std::to_string(k), summary.estimates).value;
    };
    EXPECT_GT(exponent(1), exponent(2));
    EXPECT_GT(exponent(2), 0.1);
    EXPECT_NEAR(exponent(6), -exponent(1), 1e-4);
    EXPECT_NEAR(exponent(5), -exponent(2), 1e-4);
    for (const char* zero : {"lyapunov_3", "lyapunov_4", "lyapunov_sum"}) {
      const Estimate& estimate = Named(zero, summary.estimates);
      EXPECT_LT(std::fabs(estimate.value), *estimate.standard_error) << zero << " at rho " << rho;
      EXPECT_LT(*estimate.standard_error, 1e-10);
    }
  }
}

}  // namespace
}  // namespace ballpiston
