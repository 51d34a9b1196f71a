// The first-hit experiment against an independent program's table, and against what is exact.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/statistical/run_point.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using Row = std::map<std::string, double>;

std::vector<Row> ReferenceRows() {
  std::ifstream file(SourcePath("tests/data/first_hit.csv"));
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::string> columns;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) columns.push_back(cell);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (Row& row = rows.emplace_back(); const std::string& column : columns) {
      std::getline(cells, cell, ',');
      row[column] = std::stod(cell);
    }
  }
  return rows;
}

EnsembleSpec SpecOf(double rho, double delta, double epsilon, double exponent, int64_t samples) {
  EnsembleSpec spec = {
      .experiment = Experiment::kFirstHit,
      .grid = {.rho = {rho}, .delta = {delta}, .epsilon = {epsilon}, .exponent = {exponent}},
      .target = {.samples = samples}};
  spec.seed = 20;
  return spec;
}

double CombinedZ(double a, double a_error, double b, double b_error) {
  const double error = std::hypot(a_error, b_error);
  return error == 0 ? (a == b ? 0 : INFINITY) : (a - b) / error;
}

class FirstHitTable : public testing::TestWithParam<size_t> {};

// Four means and a divergence within 4 combined standard errors: 6e-5 false alarms each, 0.6
// percent over the 100 comparisons of the table.
TEST_P(FirstHitTable, AgreesWithAnIndependentProgram) {
  const Row row = ReferenceRows().at(GetParam());
  const PointSummary summary = RunPoint(
      SpecOf(row.at("rho"), row.at("delta"), row.at("epsilon"), row.at("exponent"), 400'000));
  const double samples = row.at("samples"), sigma = row.at("mean_sigma");
  const double time_z = CombinedZ(summary.estimates[0].value, *summary.estimates[0].standard_error,
                                  row.at("mean_time"), row.at("mean_time_se"));
  const double cos_z = CombinedZ(summary.estimates[1].value, *summary.estimates[1].standard_error,
                                 row.at("mean_cos_alpha"), row.at("mean_cos_alpha_se"));
  const double sigma_z = CombinedZ(summary.estimates[2].value, *summary.estimates[2].standard_error,
                                   sigma, std::sqrt((1 - sigma * sigma) / samples));
  const KlDivergence expected = {.value = row.at("kl_1000_bins"),
                                 .noise_floor = row.at("kl_noise"),
                                 .cells = summary.kl_divergence->cells};
  const double kl_z =
      CombinedZ(summary.kl_divergence->value, summary.kl_divergence->StandardError(),
                expected.value, expected.StandardError());
  // The table's coefficients of variation have four digits and no error; both runs have the same
  // number of samples, so the same error.
  const double cv_z = CombinedZ(summary.estimates[3].value, *summary.estimates[3].standard_error,
                                row.at("coefficient_of_variation"),
                                std::hypot(*summary.estimates[3].standard_error, 5e-5));
  std::cout << std::fixed << std::setprecision(2) << "z: time " << time_z << "  cos " << cos_z
            << "  sigma " << sigma_z << "  kl " << kl_z << "  cv " << cv_z << "\n";
  EXPECT_NEAR(summary.kl_divergence->noise_floor, row.at("kl_noise"), 1e-6);
  EXPECT_LT(std::fabs(time_z), 4);
  EXPECT_LT(std::fabs(cos_z), 4);
  EXPECT_LT(std::fabs(sigma_z), 4);
  EXPECT_LT(std::fabs(kl_z), 4);
  EXPECT_LT(std::fabs(cv_z), 4);
}

INSTANTIATE_TEST_SUITE_P(Rows, FirstHitTable, testing::Range<size_t>(0, 20));

// The invariant law is its own ingoing law at every delta: the divergence is noise, and the means
// are the closed forms. 4 standard errors, 24 comparisons: 0.2 percent false alarms.
TEST(FirstHit, OfTheInvariantLawSitsOnTheNoiseFloor) {
  for (const double delta : {0.325, 0.1}) {
    for (const double epsilon : {0.03125, 0.25, 0.46875}) {
      const PointSummary summary = RunPoint(SpecOf(0.529561127988977, delta, epsilon, 1, 200'000));
      const KlDivergence& kl = *summary.kl_divergence;
      const double noise_error = std::sqrt(2.0 * (kl.cells - 1)) / (2.0 * 200'000);
      EXPECT_NEAR(kl.value, kl.noise_floor, 4 * noise_error) << delta << " " << epsilon;
      for (size_t i = 0; i < 3; ++i) {
        const Estimate& estimate = summary.estimates[i];
        if (const auto z = estimate.ZScore()) {
          EXPECT_LT(std::fabs(*z), 4) << estimate.name << " at " << delta << " " << epsilon;
        } else {
          EXPECT_EQ(estimate.value, estimate.exact) << estimate.name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
