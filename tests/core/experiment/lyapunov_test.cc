// The experiments `lyapunov` and `gas-lyapunov`.
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

double ValueOf(const std::string& name, const PointSummary& summary) {
  return Named(name, summary.estimates).value;
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
      EnsembleSpec spec = Asked(absl::StrCat("lyapunov rho=0.53 delta=", reference.delta,
                                             " collisions=", collisions, " model=", Name(model)));
      spec.precision = precision;
      const PointSummary summary = RunPoint(spec);
      ExpectNear(Named("lyapunov_1", summary.estimates), reference.first, reference.first_error);
      ExpectNear(Named("lyapunov_2", summary.estimates), reference.second, reference.second_error);
      ExpectNear(Named("entropy", summary.estimates), reference.first + reference.second,
                 reference.first_error);
      const Estimate& time = Named("mean_free_time_ball_piston", summary.estimates);
      EXPECT_LT(std::fabs(*time.ZScore()), 4);
    }
  }
}

TEST(Lyapunov, ExponentsOfACollisionAreThoseOfItsTime) {
  const PointSummary summary =
      RunPoint("lyapunov rho=0.6 delta=0.05 collisions=10000 model=billiard");
  const double time = ValueOf("mean_free_time_ball_piston", summary);
  for (const std::string name : {"lyapunov_1", "lyapunov_2"}) {
    EXPECT_NEAR(ValueOf(name + "_per_collision", summary), time * ValueOf(name, summary),
                1e-12 * time * 20);
  }
}

// lambda_k = -lambda_(7-k). Rounding costs the smallest vector the most digits. Where the true
// value is 0, rounding is a bias that a scatter does not show, and the stated error is larger.
TEST(PairTangents, ExponentsComeInPairs) {
  for (const double rho : {0.501, 0.53, 0.7}) {
    const PointSummary summary =
        RunPoint(absl::StrCat("lyapunov collisions=3200 model=billiard_reference rho=", rho,
                              " delta=", 0.9 * PairDeltaBound(rho)));
    const auto exponent = [&](int k) { return ValueOf(absl::StrCat("lyapunov_", k), summary); };
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

// ---- gas-lyapunov ----

// False alarms: 6e-5 for each shape.
TEST(GasLyapunov, TheExchangeRateIsTheCanonicalMean) {
  for (const char* cells : {"1", "3", "2x2"}) {
    const PointSummary summary =
        RunPoint(absl::StrCat("gas-lyapunov delta=0.19 temperature=3 samples=100 cells=", cells));
    EXPECT_LT(std::fabs(*Named("exchange_rate", summary.estimates).ZScore()), 4) << cells;
  }
}

TEST(GasLyapunov, ExponentsAreInOrderAndTheirSumIsTheEntropy) {
  const PointSummary summary = RunPoint("gas-lyapunov cells=4 temperature=1 samples=60");
  double sum = ValueOf("lyapunov_1", summary);
  for (int k = 2; k <= 11; ++k) {
    const double exponent = ValueOf(absl::StrCat("lyapunov_", k), summary);
    EXPECT_LT(exponent, ValueOf(absl::StrCat("lyapunov_", k - 1), summary));
    EXPECT_GT(exponent, 0);
    sum += exponent;
  }
  EXPECT_NEAR(ValueOf("entropy_per_ball", summary), sum / 4, 1e-12 * sum);
}

// A ball alone in its cell has the exponent lambda_cell at speed 1. Where exchanges are rare, the
// pair's first exponent is that times a ball's mean speed, pi/4 at the energy 1/2; the gas's
// entropy per ball is that times the mean speed sqrt(pi T/2), and a slow part: each exchange of a
// ball adds about ln(time between exchanges) + 0.5. A tenth of the slow part is left for the
// constant, which is not known better. False alarms: 6e-5.
TEST(GasLyapunov, TheEntropyIsThatOfTheCellsWhereExchangesAreRare) {
  constexpr double kTemperatureHere = 2;
  const PointSummary of_pair = RunPoint("lyapunov delta=0.04 collisions=20000 model=billiard");
  const double of_cell = ValueOf("lyapunov_1", of_pair) * 4 / std::numbers::pi;
  const PointSummary gas = RunPoint("gas-lyapunov delta=0.04 temperature=2 samples=100");
  const double rate = ValueOf("exchange_rate", gas);
  const double slow = 2 * rate * (0.5 - std::log(rate / std::sqrt(kTemperatureHere)));
  const Estimate& entropy = Named("entropy_per_ball", gas.estimates);
  const double expected = std::sqrt(std::numbers::pi * kTemperatureHere / 2) * of_cell + slow;
  const double scatter = std::hypot(
      *entropy.standard_error, expected * RelativeError(Named("lyapunov_1", of_pair.estimates)));
  EXPECT_NEAR(entropy.value, expected, 0.1 * slow + 4 * scatter);
}

TEST(GasLyapunov, TheExponentsThatRoundingChangesHaveNoErrors) {
  const PointSummary three = RunPoint("gas-lyapunov delta=0.19 cells=3 samples=60");
  for (int k = 1; k <= 8; ++k) {
    const Estimate& exponent = Named(absl::StrCat("lyapunov_", k), three.estimates);
    EXPECT_EQ(exponent.standard_error.has_value(), k != 2 && k != 3) << k;
  }
  EXPECT_THAT(three.remarks, Contains(HasSubstr("lyapunov_2 to lyapunov_3 have no standard")));
  const PointSummary two = RunPoint("gas-lyapunov delta=0.19 samples=60");
  EXPECT_TRUE(Named("lyapunov_2", two.estimates).standard_error.has_value());
  EXPECT_THAT(two.remarks, IsEmpty());
}

}  // namespace
}  // namespace ballpiston
