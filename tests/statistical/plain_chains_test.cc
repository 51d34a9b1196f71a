// Compares gas-conduction by the jump process with a plain program that shares no physics with
// core/ (tests/oracle/plain_jump_chain.h): the current, its cumulants, the exchange rate and the
// temperatures.
#include "core/experiment/gas_experiment.h"
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/plain_jump_chain.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr double kHotEnd = 1.5, kColdEnd = 0.5;
constexpr unsigned kRuns = 64;

// The windows of a run; pairs of them make the windows of twice the length. A window's work grows
// as N (N + 1)^2, so a long chain has fewer. Those are too few for the third and the fourth
// cumulant, whose scatter is far from normal: of 64 runs with 32 windows one has been 6 errors off.
bool IsLong(size_t cells) { return cells > 8; }
int Windows(size_t cells) { return IsLong(cells) ? 32 : 128; }

struct PlainResult {
  Moments current, rate;
  std::array<Moments, 3> cumulants;  // the second to the fourth
  std::vector<Moments>
      temperatures;  // ball, piston, ball, ..., ball: without the outermost pistons
};

// The second to the fourth cumulant, without bias (Fisher's k-statistics).
std::array<double, 3> Cumulants(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::reduce(values.begin(), values.end()) / n;
  double square = 0, cube = 0, fourth = 0;
  for (const double value : values) {
    square += std::pow(value - mean, 2) / n;
    cube += std::pow(value - mean, 3) / n;
    fourth += std::pow(value - mean, 4) / n;
  }
  return {
      square * n / (n - 1), cube * n * n / ((n - 1) * (n - 2)),
      ((n + 1) * fourth - 3 * (n - 1) * square * square) * n * n / ((n - 1) * (n - 2) * (n - 3))};
}

// How the cumulants grow with the window, in a unit of time: constant parts cancel.
std::array<double, 3> CumulantGrowths(const std::vector<double>& charges, double window) {
  std::vector<double> pairs;
  for (size_t i = 0; i + 1 < charges.size(); i += 2) pairs.push_back(charges[i] + charges[i + 1]);
  const std::array single = Cumulants(charges);
  std::array growths = Cumulants(pairs);
  for (size_t i = 0; i < growths.size(); ++i) growths[i] = (growths[i] - single[i]) / window;
  return growths;
}

void AddRun(PlainJumpChain chain, double window, int windows, PlainResult& result) {
  chain.Run(4 * window);
  chain.Forget();
  std::vector<double> charges;
  for (int i = 0; i < windows; ++i) {
    const double before = chain.charge();
    chain.Run(window);
    charges.push_back(chain.charge() - before);
  }
  result.current.Add(chain.charge() / chain.time());
  const std::array growths = CumulantGrowths(charges, window);
  for (size_t i = 0; i < growths.size(); ++i) result.cumulants[i].Add(growths[i]);
  result.rate.Add(chain.rate());
  for (size_t i = 0; i < result.temperatures.size(); ++i) {
    result.temperatures[i].Add(i % 2 == 0 ? chain.ball_temperature(i / 2)
                                          : chain.piston_temperature(i / 2 + 1));
  }
}

// A window is several times the longest relaxation time, which is about (N + 1)^2/3 exchange times.
// `density`: of the exchanges (plain_jump_chain.h).
PlainResult PlainRuns(size_t cells, double density) {
  PlainResult result;
  result.temperatures.resize(2 * cells - 1);
  const auto length = static_cast<double>(cells + 1);
  for (unsigned run = 0; run < kRuns; ++run) {
    const unsigned seed = 1000 * run + static_cast<unsigned>(cells);
    AddRun(PlainJumpChain(cells, density, kHotEnd, kColdEnd, seed), 4 * length * length / density,
           Windows(cells), result);
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

constexpr uint64_t kSamplesOfTheFourth = uint64_t{1} << 20;  // which its cumulant needs

void Compare(const PointSummary& product, const PlainResult& plain, Comparison& comparison) {
  const auto add = [&](const char* name, const Moments& moments) {
    const Estimate& estimate = Named(name, product.estimates);
    comparison.Add(name, moments, estimate.value, estimate.standard_error);
  };
  add("heat_current", plain.current);
  add("charge_cumulant_2", plain.cumulants[0]);
  if (!IsLong(plain.temperatures.size() / 2 + 1)) add("charge_cumulant_3", plain.cumulants[1]);
  if (product.samples >= kSamplesOfTheFourth) add("charge_cumulant_4", plain.cumulants[2]);
  add("exchange_rate", plain.rate);
  const std::vector<CurvePoint>& profile = product.curves.front().points;
  ASSERT_EQ(profile.size(), plain.temperatures.size() + 2);
  for (size_t i = 0; i < plain.temperatures.size(); ++i) {
    comparison.Add("temperature", plain.temperatures[i], profile[i + 1].value,
                   profile[i + 1].standard_error);
  }
}

// By the number of cells, N. Chains that take minutes run nightly.
class PlainChains : public testing::TestWithParam<int64_t> {};

INSTANTIATE_TEST_SUITE_P(Cells, PlainChains, testing::Values(1, 2, 4, 8, 16),
                         testing::PrintToStringParamName());

// A chain of N cells makes 2 + 2 N to 4 + 2 N comparisons, with errors from 64 runs and 128
// trajectories. The five chains make 80 comparisons. One of these is above 4.5 standard errors for
// one seed in 500, if all are independent; the mean square of 6 is above 3.5 for one seed in 500,
// and that of more for fewer. Neighbouring temperatures are not independent, so a longer chain gets
// no smaller bound.
TEST_P(PlainChains, TheJumpProcessBetweenReservoirsIsThatOfAPlainProgram) {
  if (GetParam() > 4 && !IsNightly()) GTEST_SKIP() << "a nightly test";
  const auto cells = static_cast<size_t>(GetParam());
  const PointParameters point = PaperGas(&kGasConduction, 0.2, GasShape{GetParam()});
  const GasGeometry gas = GasGeometryOf(point, GasEnds::kReservoirs);
  const double density = std::sqrt(std::numbers::pi) * InfiniteGasExchangeRate(gas, 1);
  const int64_t samples = GetParam() == 1 ? 1'049'000 : 264'000;
  Comparison comparison;
  Compare(RunPoint(SpecOf(&kGasConduction, point, {.samples = samples}, Model::kMarkov, 3)),
          PlainRuns(cells, density), comparison);
  EXPECT_LT(comparison.MeanSquare(), 3.5);
}

}  // namespace
}  // namespace ballpiston
