// Compares gas-conduction with plain programs that share no physics with core/: the jump process
// with tests/oracle/plain_jump_chain.h, the billiard with tests/data/gas.csv.
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/asked.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/plain_jump_chain.h"
#include "tests/oracle/reference_table.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr double kHotEnd = 1.5, kColdEnd = 0.5;
constexpr unsigned kRuns = 64;

// The windows of a run; pairs of them make the windows of twice the length. A window's work grows
// as N (N + 1)^2, so a long chain has fewer. Those are too few for the third cumulant, whose
// scatter is far from normal: of 64 runs with 32 windows one has been 6 errors off. The fourth
// needs a million samples of the product.
bool IsLong(size_t cells) { return cells > 8; }
int Windows(size_t cells) { return IsLong(cells) ? 32 : 128; }
size_t MostCumulant(size_t cells) { return cells == 1 ? 4 : IsLong(cells) ? 2 : 3; }

// The second to the fourth cumulant, without bias (Fisher's k-statistics).
std::array<double, 3> Cumulants(const std::vector<double>& values) {
  Moments moments;
  for (const double value : values) moments.Add(value);
  const auto n = static_cast<double>(values.size());
  const double square = moments.m2 / n, cube = moments.m3 / n, fourth = moments.m4 / n;
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

// By the names of the estimates, and "profile" and a place of it.
using PlainResult = std::map<std::string, Moments>;

void AddRun(size_t cells, PlainJumpChain chain, double window, PlainResult& result) {
  chain.Run(4 * window);
  chain.Forget();
  std::vector<double> charges;
  for (int i = 0; i < Windows(cells); ++i) {
    const double before = chain.charge();
    chain.Run(window);
    charges.push_back(chain.charge() - before);
  }
  result["heat_current"].Add(chain.charge() / chain.time());
  result["exchange_rate"].Add(chain.rate());
  const std::array growths = CumulantGrowths(charges, window);
  for (size_t n = 2; n <= MostCumulant(cells); ++n) {
    result[absl::StrCat("charge_cumulant_", n)].Add(growths[n - 2]);
  }
  for (size_t place = 1; place < 2 * cells; ++place) {
    result[absl::StrCat("profile ", place)].Add(chain.temperature(place));
  }
}

// A window is several times the longest relaxation time, which is about (N + 1)^2/3 exchange times.
// `density`: of the exchanges (plain_jump_chain.h).
PlainResult PlainRuns(size_t cells, double density) {
  PlainResult result;
  const auto length = static_cast<double>(cells + 1);
  for (unsigned run = 0; run < kRuns; ++run) {
    const unsigned seed = 1000 * run + static_cast<unsigned>(cells);
    AddRun(cells, PlainJumpChain(cells, density, kHotEnd, kColdEnd, seed),
           4 * length * length / density, result);
  }
  return result;
}

// The value and its standard error, by the names of PlainResult.
std::pair<double, double> Measured(const std::string& quantity, const PointSummary& summary) {
  const std::vector<std::string> words = absl::StrSplit(quantity, ' ');
  if (words[0] == "profile") {
    const CurvePoint& place = summary.curves.front().points.at(std::stoul(words.at(1)));
    return {place.value, place.standard_error.value()};
  }
  const Estimate& estimate = Named(quantity, summary.estimates);
  return {estimate.value, estimate.standard_error.value()};
}

// By the number of cells, N. Chains that take minutes run nightly.
class PlainChains : public testing::TestWithParam<int64_t> {};

INSTANTIATE_TEST_SUITE_P(Cells, PlainChains, testing::Values(1, 2, 4, 8, 16),
                         testing::PrintToStringParamName());

// A chain of N cells makes 2 + 2 N to 4 + 2 N comparisons, with errors from 64 runs and 128
// trajectories. The five chains make 77 comparisons. One of these is above 4.5 standard errors for
// one seed in 500, if all are independent; the mean square of 6 is above 3.5 for one seed in 500,
// and that of more for fewer. Neighbouring temperatures are not independent, so a longer chain gets
// no smaller bound.
TEST_P(PlainChains, TheJumpProcessBetweenReservoirsIsThatOfAPlainProgram) {
  if (GetParam() > 4 && !IsNightly()) GTEST_SKIP() << "a nightly test";
  const PointParameters point = PaperGas(&kGasConduction, 0.2, GasShape{GetParam()});
  const GasGeometry gas = GasGeometryOf(point, GasEnds::kReservoirs);
  const double density = std::sqrt(std::numbers::pi) * InfiniteGasExchangeRate(gas, 1);
  const int64_t samples = GetParam() == 1 ? 1'049'000 : 264'000;
  const PointSummary summary =
      RunPoint(SpecOf(&kGasConduction, point, {.samples = samples}, Model::kMarkov, 3));
  Moments squares;
  for (const auto& [quantity, plain] : PlainRuns(static_cast<size_t>(GetParam()), density)) {
    const auto [value, error] = Measured(quantity, summary);
    const double z = (value - plain.mean) / std::hypot(plain.StandardError().value(), error);
    EXPECT_LT(std::fabs(z), 4.5) << quantity;
    squares.Add(z * z);
  }
  EXPECT_LT(squares.mean, 3.5);
}

// 4 standard errors of both: 6e-5 false alarms.
TEST(PlainBilliard, ItsHeatCurrentIsThatOfAnIndependentProgram) {
  const oracle::ReferenceRow row = oracle::ReferenceTable("gas.csv").at(0);
  ASSERT_EQ(row.at("quantity"), "heat_current");
  const auto [value, error] =
      Measured("heat_current", RunPoint(Asked("gas-conduction delta=0.15 cells=2 hot=2 cold=1 "
                                              "model=billiard samples=24000 seed=3")));
  EXPECT_NEAR(value, oracle::Number(row, "value"),
              4 * std::hypot(error, oracle::Number(row, "standard_error")));
}

}  // namespace
}  // namespace ballpiston
