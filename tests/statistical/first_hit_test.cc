// Compares the first-hit experiment with a table that an independent program computed.
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

constexpr size_t kRows = 20;

// A row of tests/data/first_hit.csv, by the names of the columns.
std::map<std::string, double> ReferenceRow(size_t row) {
  const std::vector<std::string> lines =
      absl::StrSplit(Contents(SourcePath("tests/data/first_hit.csv")), '\n', absl::SkipEmpty());
  EXPECT_EQ(lines.size(), 1 + kRows);
  const std::vector<std::string> names = absl::StrSplit(lines.at(0), ','),
                                 cells = absl::StrSplit(lines.at(1 + row), ',');
  std::map<std::string, double> values;
  for (size_t i = 0; i < names.size(); ++i)
    values[names[i]] = std::strtod(cells.at(i).c_str(), nullptr);
  return values;
}

double CombinedZ(double a, double a_error, double b, double b_error) {
  const double error = std::hypot(a_error, b_error);
  return error == 0 ? (a == b ? 0 : INFINITY) : (a - b) / error;
}

class FirstHitTable : public testing::TestWithParam<size_t> {};

// Four means and a divergence within 4 combined standard errors: 6e-5 false alarms each, 0.6
// percent over the 100 comparisons of the table.
TEST_P(FirstHitTable, AgreesWithAnIndependentProgram) {
  const std::map<std::string, double> row = ReferenceRow(GetParam());
  const auto reference = [&row](const char* column) { return row.at(column); };
  const PointParameters point = {{kRho, reference("rho")},
                                 {kDelta, reference("delta")},
                                 {kEpsilon, reference("epsilon")},
                                 {kExponent, reference("exponent")}};
  const PointSummary summary =
      RunPoint(SpecOf(&kFirstHit, point, {.samples = 400'000}, Model::kBilliard, 20));
  const double samples = reference("samples"), sigma = reference("mean_sigma");
  const auto expect_near = [&](size_t estimate, double value, double error) {
    const Estimate& measured = summary.estimates[estimate];
    EXPECT_LT(std::fabs(CombinedZ(measured.value, *measured.standard_error, value, error)), 4)
        << measured.name;
  };
  expect_near(0, reference("mean_time"), reference("mean_time_se"));
  expect_near(1, reference("mean_cos_alpha"), reference("mean_cos_alpha_se"));
  expect_near(2, sigma, std::sqrt((1 - sigma * sigma) / samples));
  // The table's coefficients of variation have four digits and no error; both runs have the same
  // number of samples, so the same error. Likewise the divergences.
  expect_near(3, reference("coefficient_of_variation"),
              std::hypot(*summary.estimates[3].standard_error, 5e-5));
  expect_near(4, reference("kl_1000_bins"), *summary.estimates[4].standard_error);
  EXPECT_EQ(summary.estimates[4].name, "kl_divergence");
  // The table's is that of the chi-squared law; the thinnest cells have some counts only.
  EXPECT_NEAR(*summary.estimates[4].noise_floor / reference("kl_noise"), 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Rows, FirstHitTable, testing::Range<size_t>(0, kRows));

}  // namespace
}  // namespace ballpiston
