// gas-conduction by the billiard and by the jump process beside plain programs, which share no
// physics with core/ (tests/oracle/plain_billiard_chain.h, plain_jump_chain.h): the current, its
// noise, the exchange rate and the temperatures.
#include "core/ensemble/experiment_kind.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/plain_billiard_chain.h"
#include "tests/oracle/plain_jump_chain.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr double kHotEnd = 1.5, kColdEnd = 0.5;
constexpr unsigned kRuns = 64;
constexpr int kWindows = 128;  // of a run; pairs of them make the windows of twice the length

struct PlainResult {
  Moments current, noise, rate;
  std::vector<Moments>
      temperatures;  // ball, piston, ball, ..., ball: without the outermost pistons
};

// The growth of the variance with the window, in a unit of time: a constant part of the variance
// cancels.
double Noise(const std::vector<double>& charges, double window) {
  Moments single, twice;
  for (const double charge : charges) single.Add(charge);
  for (size_t i = 0; i + 1 < charges.size(); i += 2) twice.Add(charges[i] + charges[i + 1]);
  return (*twice.Variance() - *single.Variance()) / window;
}

template <typename Chain>
void AddRun(Chain chain, double window, PlainResult& result) {
  chain.Run(4 * window);
  chain.Forget();
  std::vector<double> charges;
  for (int i = 0; i < kWindows; ++i) {
    const double before = chain.charge();
    chain.Run(window);
    charges.push_back(chain.charge() - before);
  }
  result.current.Add(chain.charge() / chain.time());
  result.noise.Add(Noise(charges, window));
  result.rate.Add(chain.rate());
  for (size_t i = 0; i < result.temperatures.size(); ++i) {
    result.temperatures[i].Add(i % 2 == 0 ? chain.ball_temperature(i / 2)
                                          : chain.piston_temperature(i / 2 + 1));
  }
}

// A window is several times the longest relaxation time, which is about (N + 1)^2/3 exchange times.
// `density`: of the exchanges (plain_jump_chain.h); `start` makes the chain of a seed.
template <typename Start>
PlainResult PlainRuns(size_t cells, double density, Start start) {
  PlainResult result;
  result.temperatures.resize(2 * cells - 1);
  const auto length = static_cast<double>(cells + 1);
  for (unsigned run = 0; run < kRuns; ++run) {
    AddRun(start(1000 * run + static_cast<unsigned>(cells)), 4 * length * length / density, result);
  }
  return result;
}

class Comparison {
 public:
  void Add(const std::string& name, const Moments& plain, double value,
           std::optional<double> error) {
    ASSERT_TRUE(error.has_value()) << name;
    const double z = (value - plain.mean) / std::hypot(plain.StandardError().value(), *error);
    EXPECT_LT(std::fabs(z), 4.5) << name;
    squares_.Add(z * z);
  }
  double MeanSquare() const { return squares_.mean; }

 private:
  Moments squares_;
};

void Compare(const PointSummary& product, const PlainResult& plain, Comparison& comparison) {
  const auto add = [&](const char* name, const Moments& moments) {
    for (const Estimate& estimate : product.estimates) {
      if (estimate.name != name) continue;
      return comparison.Add(name, moments, estimate.value, estimate.standard_error);
    }
    ADD_FAILURE() << "no estimate " << name;
  };
  add("heat_current", plain.current);
  add("charge_cumulant_2", plain.noise);
  add("exchange_rate", plain.rate);
  const std::vector<CurvePoint>& profile = product.curves.front().points;
  ASSERT_EQ(profile.size(), plain.temperatures.size() + 2);
  for (size_t i = 0; i < plain.temperatures.size(); ++i) {
    comparison.Add("temperature", plain.temperatures[i], profile[i + 1].value,
                   profile[i + 1].standard_error);
  }
}

double DensityOf(const PointParameters& point) {
  const GasGeometry gas = GasGeometryOf(point, GasEnds::kReservoirs);
  return std::sqrt(std::numbers::pi) * InfiniteGasExchangeRate(gas, 1);
}

PointSummary ByTheProduct(const PointParameters& point, Model model, int64_t samples) {
  return RunPoint(SpecOf(&kGasConduction, point, {.samples = samples}, model, 3));
}

// 20 comparisons, or 38 in the nightly test. With errors of 64 runs and 128 trajectories, one is
// above 4.5 standard errors for one seed in 1000, and the mean square above 2 for one in 200, if
// all are independent.
TEST(PlainChains, TheJumpProcessBetweenReservoirsIsThatOfAPlainProgram) {
  Comparison comparison;
  for (const int64_t cells : {1, 2, 4, 8}) {
    if (cells > 4 && !IsNightly()) break;
    const auto count = static_cast<size_t>(cells);
    const PointParameters point = PaperGas(&kGasConduction, 0.2, GasShape{cells});
    const double density = DensityOf(point);
    Compare(ByTheProduct(point, Model::kMarkov, 240'000),
            PlainRuns(count, density,
                      [&](unsigned seed) {
                        return PlainJumpChain(count, density, kHotEnd, kColdEnd, seed);
                      }),
            comparison);
  }
  EXPECT_LT(comparison.MeanSquare(), 2);
}

// 4 comparisons, or 20 in the nightly test. Of 4 independent ones the mean square is above 3.5 for
// one seed in 140.
TEST(PlainChains, TheBilliardBetweenReservoirsIsThatOfAPlainProgram) {
  constexpr double kDelta = 0.15;
  Comparison comparison;
  for (const int64_t cells : {1, 2, 4}) {
    if (cells > 1 && !IsNightly()) break;
    const auto count = static_cast<size_t>(cells);
    const PointParameters point = PaperGas(&kGasConduction, kDelta, GasShape{cells});
    Compare(ByTheProduct(point, Model::kBilliard, 60'000),
            PlainRuns(count, DensityOf(point),
                      [&](unsigned seed) {
                        return PlainBilliardChain(count, kPaperRho, kDelta, kHotEnd, kColdEnd,
                                                  seed);
                      }),
            comparison);
  }
  EXPECT_LT(comparison.MeanSquare(), 3.5);
}

}  // namespace
}  // namespace ballpiston
