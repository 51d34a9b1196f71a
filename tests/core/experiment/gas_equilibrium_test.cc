// The experiment `gas-equilibrium`: estimates, exact values, laws of speeds.
#include "core/conductivity/conductivity.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecAt(double temperature, Model model = Model::kBilliard,
                    const GasShape& shape = {.columns = 3}) {
  PointParameters point = PaperGas(&kGasEquilibrium, 0.2, shape);
  point.Set(kTemperature, temperature);
  return SpecOf(&kGasEquilibrium, point, {.samples = 400}, model, 7);
}

TEST(GasEquilibrium, EstimatesHaveTheirNamesAndExactValues) {
  for (const auto& [shape, model] : {std::pair(GasShape{1}, Model::kBilliard),
                                     {GasShape{3}, Model::kBilliard},
                                     {GasShape{2, 3, true}, Model::kBilliard},
                                     {GasShape{3}, Model::kMarkov},
                                     {GasShape{3}, Model::kBilliardReference}}) {
    const PointSummary summary = RunPoint(SpecAt(2, model, shape));
    EXPECT_THAT(NamesOf(summary),
                ElementsAre("exchange_rate", "temperature_ball", "temperature_piston",
                            "ball_speed_divergence", "piston_speed_divergence", "conductivity",
                            "conductivity_ratio"));
    const GasGeometry geometry =
        GasGeometry::Create(kPaperRho, 0.2, shape, GasEnds::kPeriodic).value();
    EXPECT_EQ(summary.estimates[0].exact, GasExchangeRate(geometry, 2));
    EXPECT_EQ(summary.estimates[1].exact, 2);
    EXPECT_EQ(summary.estimates[2].exact, 2);
    EXPECT_THAT(summary.remarks,
                Contains(HasSubstr(model == Model::kMarkov ? " 8 mean times between exchanges"
                                                           : " 4 mean times between exchanges")));
  }
}

// The last of the ratios by window is the ratio. By the jump process a ring of three cells has
// -0.00165(3), so it is within 2e-4 and five errors of the limit. So few replicas show no error.
TEST(GasEquilibrium, RatiosByWindowEndAtTheRatio) {
  for (const Model model : {Model::kBilliard, Model::kMarkov}) {
    const PointSummary summary = RunPoint(SpecAt(2, model));
    const Estimate& ratio = summary.estimates.back();
    ASSERT_EQ(summary.curves[0].name, "conductivity_ratio_by_window");
    EXPECT_EQ(summary.curves[0].points.back().value, ratio.value);
    EXPECT_EQ(ratio.limit, 1 + kChainCorrection.value);
    if (model == Model::kBilliard) continue;
    EXPECT_FALSE(ratio.standard_error);
    EXPECT_LT(std::fabs(ratio.value - *ratio.limit), 5 * 1e-4 + 2e-4);
  }
}

// Without correlations the conductivity is exactly half of the exchange rate, which the jump
// process has rounded.
TEST(GasEquilibrium, TheConductivityOfOneColumnHasTheErrorOfTheRoundedRate) {
  for (const GasShape& shape : {GasShape{1}, GasShape{1, 3, true}}) {
    EnsembleSpec spec = SpecAt(2, Model::kMarkov, shape);
    spec.target.estimate = "conductivity";
    const PointSummary summary = RunPoint(spec);
    const Estimate& conductivity = summary.estimates[0];
    const double exact = *summary.estimates[2].exact / 2;  // of the exchange rate
    EXPECT_NEAR(conductivity.value, exact, *conductivity.standard_error);
    EXPECT_LT(*conductivity.standard_error, 1.1 * kRoundingOfTheRate * exact);
  }
}

// The conductivity is measured up to 5000 contacts. A question that names it for a larger gas is
// rejected.
TEST(GasEquilibrium, ConductivityIsMeasuredUpTo5000Contacts) {
  for (const auto& [columns, has] : {std::pair(2500, true), {2501, false}}) {
    EnsembleSpec spec = SpecAt(1, Model::kMarkov, {.columns = columns});
    spec.target = {.samples = 2};
    const PointSummary summary = RunPoint(spec);
    EXPECT_EQ(summary.estimates.size(), has ? 7u : 5u);
    EXPECT_EQ(summary.curves.empty(), !has);
    EXPECT_EQ(summary.remarks.size(), has ? 3u : 2u);  // two replicas have no errors
    spec.target.estimate = "conductivity";
    for (const Model model : {Model::kAuto, Model::kBilliard, Model::kSpectrum}) {
      spec.model = model;
      if (model == Model::kSpectrum) spec.target.samples.reset();
      const std::vector<FieldViolation> found = Violations(spec);
      EXPECT_EQ(found.empty(), has || model == Model::kSpectrum);
      for (const FieldViolation& violation : found) EXPECT_EQ(violation.field, "grid.cells[0]");
    }
  }
}

// The conductivity is half of the exchange rate, times a factor that depends only on the shape. The
// tests of core/conductivity check the factor.
TEST(GasEquilibrium, TheSpectrumGivesTheConductivity) {
  for (const auto& [shape, correction] :
       {std::pair(GasShape{5}, kChainCorrection), {GasShape{4, 3, true}, kLatticeCorrection}}) {
    for (const double delta : {0.19, 0.01}) {
      EnsembleSpec spec =
          SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, delta, shape), {}, Model::kSpectrum);
      const PointSummary summary = RunPoint(spec);
      EXPECT_THAT(NamesOf(summary),
                  ElementsAre("exchange_rate", "temperature_ball", "temperature_piston",
                              "conductivity", "conductivity_ratio"));
      spec.target.estimate = "conductivity";
      EXPECT_THAT(NamesOf(RunPoint(spec)),
                  ElementsAre("conductivity", "conductivity_ratio", "exchange_rate",
                              "temperature_ball", "temperature_piston"));
      const GasGeometry geometry =
          GasGeometry::Create(kPaperRho, delta, shape, GasEnds::kPeriodic).value();
      EXPECT_EQ(summary.estimates[0].value, GasExchangeRate(geometry, 2));
      const Estimate &conductivity = summary.estimates[3], &ratio = summary.estimates[4];
      EXPECT_EQ(ratio.value, 1 + correction.value);
      EXPECT_EQ(ratio.standard_error, correction.error);
      EXPECT_DOUBLE_EQ(conductivity.value,
                       InfiniteGasExchangeRate(geometry, 2) / 2 * (1 + correction.value));
      EXPECT_EQ(summary.remarks.size(), 1u);
    }
  }
}

// The same replicas seen as a gas at another temperature, to rounding: T is a power of 4.
TEST(GasEquilibrium, AllScalesWithTheTemperature) {
  const BlockResult merged = FoldPoint(*PointExperiment::Create(SpecAt(1), 0));
  const PointSummary unit = Summarized(SpecAt(1), merged), hot = Summarized(SpecAt(4), merged);
  // The curves: the ratio by the window, and the autocorrelation, in which two currents of T^(3/2)
  // stand, with energies in units of T.
  ExpectScaled(unit, hot, {2, 4, 4, 1, 1, 2, 1}, {1, 4}, 0.5);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(hot.histograms[i].histogram.counts, unit.histograms[i].histogram.counts);
    EXPECT_DOUBLE_EQ(hot.histograms[i].histogram.upper, 2 * unit.histograms[i].histogram.upper);
  }
}

// Of speeds v: 1 - exp(-v^2/2T) of a ball in two dimensions, erf(v/sqrt(2T)) of a piston in one.
TEST(GasEquilibrium, ExpectedProbabilitiesMatchTheThermalLaws) {
  const PointSummary summary = RunPoint(SpecAt(2));
  const auto laws = kGasEquilibrium.expected_probabilities(PointAt(SpecAt(2), 0));
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(summary.histograms.at(i).name, i == 0 ? "ball_speed" : "piston_speed");
    const Histogram& speeds = summary.histograms[i].histogram;
    EXPECT_EQ(speeds.Total(), 400u * 3);
    ASSERT_EQ(laws.at(i).size(), speeds.counts.size());
    EXPECT_NEAR(std::reduce(laws[i].begin(), laws[i].end()), 1, 1e-13);
    const auto below = [i](double v) { return i == 0 ? -std::expm1(-v * v / 4) : std::erf(v / 2); };
    for (size_t bin = 0; bin + 1 < laws[i].size(); ++bin) {
      EXPECT_NEAR(laws[i][bin], below(speeds.Edge(bin + 1)) - below(speeds.Edge(bin)), 1e-14);
    }
  }
}

}  // namespace
}  // namespace ballpiston
