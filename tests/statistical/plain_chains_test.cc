// Compares gas-conduction with plain programs that share no physics with core/: the current, its
// cumulants, the exchange rate and the temperatures of tests/data/conduction.csv.
#include "tests/core/asked.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/oracle/reference_table.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// The value, and its standard error; a quantity is an estimate, or "profile" and a place of it.
std::pair<double, double> Measured(const std::string& quantity, const PointSummary& summary) {
  const std::vector<std::string> words = absl::StrSplit(quantity, ' ');
  if (words[0] == "profile") {
    const CurvePoint& place = summary.curves.front().points.at(std::stoul(words.at(1)));
    return {place.value, place.standard_error.value()};
  }
  const Estimate& estimate = Named(quantity, summary.estimates);
  return {estimate.value, estimate.standard_error.value()};
}

struct Chain {
  const char* question;
  int64_t samples;
  bool is_nightly = false;  // takes minutes
};

class PlainChains : public testing::TestWithParam<Chain> {};

INSTANTIATE_TEST_SUITE_P(
    , PlainChains,
    testing::Values(Chain{"gas-conduction delta=0.2 cells=1 model=markov", 1'049'000},
                    Chain{"gas-conduction delta=0.2 cells=2 model=markov", 264'000},
                    Chain{"gas-conduction delta=0.2 cells=4 model=markov", 264'000},
                    Chain{"gas-conduction delta=0.2 cells=8 model=markov", 264'000, true},
                    Chain{"gas-conduction delta=0.2 cells=16 model=markov", 264'000, true},
                    Chain{"gas-conduction delta=0.15 cells=2 hot=2 cold=1 model=billiard",
                          24'000}));

// The chains make 42 comparisons. One of these is above 4.5 standard errors for one seed in 3,500,
// if all are independent; the mean square of 6 is above 3.5 for one seed in 500, and that of more
// for fewer. Neighbouring temperatures are not independent, so a longer chain gets no smaller
// bound.
TEST_P(PlainChains, TheJumpProcessBetweenReservoirsIsThatOfAPlainProgram) {
  const auto& [question, samples, is_nightly] = GetParam();
  if (is_nightly && !IsNightly()) GTEST_SKIP() << "a nightly test";
  EnsembleSpec spec = Asked(question);
  spec.target.samples = samples;
  spec.seed = 3;
  const PointSummary summary = RunPoint(spec);
  Moments squares;
  for (const oracle::ReferenceRow& row : oracle::ReferenceTable("conduction.csv")) {
    if (row.at("question") != question) continue;
    const auto [value, error] = Measured(row.at("quantity"), summary);
    const double z = (value - oracle::Number(row, "value")) /
                     std::hypot(error, oracle::Number(row, "standard_error"));
    EXPECT_LT(std::fabs(z), 4.5) << row.at("quantity");
    squares.Add(z * z);
  }
  EXPECT_GE(squares.count, 1u);
  EXPECT_LT(squares.mean, 3.5);
}

}  // namespace
}  // namespace ballpiston
