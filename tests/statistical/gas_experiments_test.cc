// Long runs of the experiments with a gas. Compares them with exact values and with independent
// programs (tests/data/gas.csv), and the stated errors with measured errors.
#include "core/ensemble/experiment_kind.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

EnsembleSpec Equilibrium(double delta, const GasShape& shape, Model model, int64_t replicas) {
  return SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, delta, shape), {.samples = replicas},
                model, 11);
}

// Samples are halves of a relaxation time; `long_runs` are twelve relaxation times each.
EnsembleSpec Conduction(double delta, const GasShape& shape, double hot, double cold, Model model,
                        int64_t long_runs) {
  PointParameters point = PaperGas(&kGasConduction, delta, shape);
  point.Set(kHot, hot);
  point.Set(kCold, cold);
  return SpecOf(&kGasConduction, point, {.samples = 24 * long_runs}, model, 11);
}

GasGeometry GeometryAt(const EnsembleSpec& spec) {
  return GasGeometryOf(PointAt(spec, 0), GasEnds::kPeriodic);
}

// The relative error that the plan states for this number of samples, over the measured error.
double StatedOverMeasured(const EnsembleSpec& spec) {
  const PointSummary summary = RunPoint(spec);
  const Estimate& first = summary.estimates.front();
  const double stated = AimOf(spec).error(spec.model, PointAt(spec, 0)) /
                        std::sqrt(static_cast<double>(summary.samples));
  return stated * std::fabs(first.value) / *first.standard_error;
}

// An error measured with 400 replicas is itself known to 1/sqrt(800) = 3.5 %, with the nightly
// test's 1000 to 2.2 %. The windows are 20 % wide: a statement that is right within 7 % (nightly 12
// %) fails for one seed in 3000.
TEST(GasExperiments, StatedErrorsInEquilibriumMatchTheMeasuredErrors) {
  for (const Model model : {Model::kMarkov, Model::kBilliard}) {
    for (const GasShape& shape : {GasShape{4}, GasShape{16}, GasShape{4, 4, true}}) {
      EXPECT_NEAR(StatedOverMeasured(Equilibrium(0.1, shape, model, IsNightly() ? 1000 : 400)), 1,
                  0.2);
    }
  }
}

// One constant serves all longer chains, and one all wider lattices, although measured errors
// differ by up to 25 % between shapes. An error measured with 1500 replicas is itself known to 5 %,
// one with 500 replicas, of large gases, to 8 %, and those with the nightly test's 4000 to 3 %. At
// the nightly sizes the ratios are from 0.83 to 1.06. So the windows leave 2.7 errors or more: one
// seed in 300 fails.
TEST(GasExperiments, StatedErrorsOfTheConductivityMatchTheMeasuredErrors) {
  const auto stated_over_measured = [](Model model, const GasShape& shape, double delta) {
    const int64_t affordable = shape.columns * shape.rows < 16 ? 1500 : 500;
    EnsembleSpec spec = Equilibrium(delta, shape, model, IsNightly() ? 4000 : affordable);
    spec.target.estimate = "conductivity";
    return StatedOverMeasured(spec);
  };
  for (const GasShape& shape : {GasShape{4}, GasShape{16}, GasShape{2, 2, true},
                                GasShape{4, 4, true}, GasShape{4, 1, true}}) {
    EXPECT_NEAR(stated_over_measured(Model::kMarkov, shape, 0.1), 1, 0.35);
  }
  EXPECT_NEAR(stated_over_measured(Model::kBilliard, {4}, 0.1), 1, 0.35);
  EXPECT_NEAR(stated_over_measured(Model::kBilliard, {4, 4, true}, 0.2), 1, 0.35);
}

// Against the value of Varadhan's formula: within four errors and 3e-6, which the window and the
// size of the gas may leave. Without the test function the error is larger by a factor of 3.5 or
// 4.4. False alarms: 1.3e-4 each.
TEST(GasExperiments, ConductivityOfTheJumpProcessMatchesTheSpectrum) {
  const int fewer = IsNightly() ? 1 : 4;
  for (const auto& [shape, replicas] : {std::pair(GasShape{16}, 10'000), {{8, 8, true}, 2000}}) {
    const EnsembleSpec spec = Equilibrium(0.1, shape, Model::kMarkov, replicas / fewer);
    const auto experiment = PointExperiment::Create(spec, 0);
    const BlockResult merged = *FoldPoint(*experiment);
    const Estimate ratio = experiment->Summarize(merged).estimates.back();
    const double of_static = GasExchangeRate(GeometryAt(spec), 1) / 2;
    const double plain = merged.moments[0].mean / of_static;
    const double plain_error = *merged.moments[0].StandardError() / of_static;
    EXPECT_LT(std::fabs(ratio.value - *ratio.limit), 4 * *ratio.standard_error + 3e-6);
    EXPECT_LT(std::fabs(plain - *ratio.limit), 4 * plain_error + 3e-6);
    EXPECT_LT(*ratio.standard_error, 1.5e-5 * std::sqrt(fewer));
    EXPECT_LT(*ratio.standard_error, plain_error / 3);
  }
}

// Between reservoirs at 1.05 and 0.95 1000 long runs know the current to 13 % only, 4000 to 6.5 %,
// and the nightly test's 10,000 to 4 %. The billiard takes most of the time, so longer chains and a
// smaller delta run only in the nightly test. Its 500 replicas know the error to 3.2 % and the
// current to 2 %. At the nightly sizes the ratios are from 0.87 to 1.04. The windows of these two
// are wider, so that each window leaves three errors or more: one seed in 700 fails.
TEST(GasExperiments, StatedErrorsOfTheCurrentMatchTheMeasuredErrors) {
  const auto stated_over_measured = [](const GasShape& shape, double hot, double cold, Model model,
                                       double delta = 0.2, int64_t long_runs = 1000) {
    return StatedOverMeasured(Conduction(delta, shape, hot, cold, model, long_runs));
  };
  for (const GasShape& shape : {GasShape{2}, GasShape{4}, GasShape{3, 3, true}}) {
    EXPECT_NEAR(stated_over_measured(shape, 1.5, 0.5, Model::kMarkov), 1, 0.2);
  }
  EXPECT_NEAR(
      stated_over_measured({4}, 1.05, 0.95, Model::kMarkov, 0.2, IsNightly() ? 10'000 : 4000), 1,
      IsNightly() ? 0.25 : 0.35);
  EXPECT_NEAR(stated_over_measured({2}, 1.5, 0.5, Model::kBilliard, 0.2, IsNightly() ? 1000 : 500),
              1, 0.25);
  if (!IsNightly()) return;
  EXPECT_NEAR(stated_over_measured({4}, 1.5, 0.5, Model::kBilliard), 1, 0.2);
  EXPECT_NEAR(stated_over_measured({2}, 2, 1, Model::kBilliard, 0.1), 1, 0.2);
}

// Of the difference, in units of both errors. 4 are exceeded once in 16,000 cases.
void ExpectAgrees(const Estimate& measured, double value, double error) {
  EXPECT_LT(std::fabs(measured.value - value), 4 * std::hypot(*measured.standard_error, error));
}

// In units of the prefactor |dG|/|G|, whose average f is 1/sqrt(2 pi) at temperature 1.
double Prefactor(double delta, const GasShape& shape) {
  const GasGeometry geometry =
      GasGeometry::Create(kPaperRho, delta, shape, GasEnds::kReservoirs).value();
  return InfiniteGasExchangeRate(geometry, 1) * std::sqrt(2 * std::numbers::pi);
}

// The table has no errors of the independent programs' temperatures; 0.006 is about three of the
// standard errors here, or more. Currents that are wrong by 2 % (two cells) or 6 % (eight cells,
// nightly 5 %) are detected.
TEST(GasExperiments, CurrentOfTheJumpProcessMatchesAnIndependentProgram) {
  const PointSummary two = RunPoint(Conduction(0.1, {2}, 1.5, 0.5, Model::kMarkov, 40'000));
  const double unit = Prefactor(0.1, {2});
  ExpectAgrees(two.estimates[0], 0.098723 * unit, 0.000181 * unit);
  const std::vector<CurvePoint>& places = two.curves[0].points;
  EXPECT_NEAR(places[1].value, 1.272, 0.006);
  EXPECT_NEAR(places[2].value, 1.026, 0.006);
  EXPECT_NEAR(places[3].value, 0.778, 0.006);
  const PointSummary eight =
      RunPoint(Conduction(0.1, {8}, 2, 1, Model::kMarkov, IsNightly() ? 4000 : 1000));
  ExpectAgrees(eight.estimates[0], 0.030476 * unit, 0.000255 * unit);
}

// Temperatures: with the nightly replicas 0.008 is about two standard errors. With fewer
// replicas the windows are four standard errors wide, and the program's own errors are a third of
// these. A current that is wrong by 10 %, nightly 4 %, is detected.
TEST(GasExperiments, CurrentOfTheBilliardMatchesAnIndependentProgram) {
  const PointSummary two =
      RunPoint(Conduction(0.15, {2}, 2, 1, Model::kBilliard, IsNightly() ? 10'000 : 1000));
  ExpectAgrees(two.estimates[0], 0.019931, 0.000150);
  const double expected[] = {1.976, 1.752, 1.512, 1.269, 1.021};
  for (size_t i = 0; i < std::size(expected); ++i) {
    const CurvePoint& place = two.curves[0].points[i];
    EXPECT_NEAR(place.value, expected[i], IsNightly() ? 0.008 : 4 * *place.standard_error) << i;
  }
}

// By all models; z-scores of 4 are exceeded once in 16,000 cases.
TEST(GasExperiments, ExchangeRatesAndTemperaturesInEquilibriumAreExact) {
  for (const Model model : kModelsThatSampleGases) {
    const int64_t most = IsNightly() ? 4000 : 600;
    const int64_t replicas = model == Model::kBilliardReference ? most / 4 : most;
    const PointSummary summary = RunPoint(Equilibrium(0.2, {4, 4, true}, model, replicas));
    for (size_t i = 0; i < 3; ++i) {
      const Estimate& estimate = summary.estimates[i];
      EXPECT_LT(std::fabs(*estimate.ZScore()), 4) << Name(model) << " " << estimate.name;
    }
    for (size_t i = 3; i < 5; ++i) {
      const Estimate& divergence = summary.estimates[i];
      EXPECT_LT(divergence.value, *divergence.noise_floor + 4 * *divergence.standard_error);
    }
  }
}

}  // namespace
}  // namespace ballpiston
