#include "core/experiment/energy_relaxation.h"

#include "core/billiard/event_flow.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/random_stream.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnergyRelaxation RelaxationAt(double delta, std::optional<double> epsilon = {}) {
  return {PaperGeometry(delta), PaperPoint(delta, epsilon)};
}

// The test follows an orbit with the reference flow, at the times of the curve.
TEST(EnergyRelaxation, OrbitsMatchTheReferenceFlow) {
  for (const double epsilon : {0.01, 0.3, 0.5}) {
    const PointParameters point = PaperPoint(0.2, epsilon);
    const EnsembleSpec spec =
        SpecOf(&kEnergyRelaxation, point, {.samples = 1}, Model::kBilliardReference);
    const BlockResult block = FoldPoint(*PointExperiment::Create(spec, 0));
    CounterRandom random(spec.seed, PointStream(spec, point), 0);
    ReferenceFlow flow(kPaperPair, DrawFromFlowMeasureAt(kPaperPair, epsilon, random));
    const double lag = 4 * EnergyRelaxation(kPaperPair, point).unit() * kWindowTimes / (kLags - 1);
    double time = 0, integral = 0;
    double energy = std::pow(flow.state().piston_velocity, 2) / 2;
    for (size_t i = 0; i < kLags;) {
      const Event event = flow.Step();
      ASSERT_NE(event.kind, EventKind::kEscape);
      const double end = std::fmin(time + event.duration, lag * (kLags - 1));
      for (; i < kLags && lag * static_cast<double>(i) < time + event.duration; ++i) {
        EXPECT_NEAR(block.moments[1 + i].mean, energy, 1e-14) << i;
      }
      integral += (energy - kMeanPistonEnergy) * (end - time);
      time += event.duration;
      if (event.kind != EventKind::kBallPiston) continue;
      flow.ExchangeComponents();
      energy = std::pow(flow.state().piston_velocity, 2) / 2;
    }
    EXPECT_NEAR(block.moments[0].mean, integral, 1e-12 * time);
  }
}

// Around 1/6 the ratio to epsilon - 1/6 has no meaning, but the integral does. A remark of every
// model says so.
TEST(EnergyRelaxation, RelaxationTimeExistsAwayFromTheMeanEnergy) {
  const auto answered = [](const std::optional<double>& epsilon, Model model) {
    const Target target = model == Model::kSpectrum ? Target{} : Target{.samples = 64};
    return RunPoint(SpecOf(&kEnergyRelaxation, PaperPoint(0.1, epsilon), target, model));
  };
  for (const auto& [epsilon, exists] : {std::pair(std::optional<double>(), true),
                                        {0.0, true},
                                        {0.12, true},
                                        {0.121, false},
                                        {1.0 / 6, false},
                                        {0.199, false},
                                        {0.2, true}}) {
    EXPECT_EQ(HasRelaxationTime(epsilon), exists);
    for (const Model model : {Model::kSpectrum, Model::kMarkov, Model::kBilliard}) {
      const PointSummary summary = answered(epsilon, model);
      const auto is_said = [](const std::string& remark) {
        return remark.starts_with("there is no relaxation_time");
      };
      EXPECT_EQ(std::ranges::count_if(summary.remarks, is_said), exists ? 0 : 1);
      if (model == Model::kBilliard) continue;
      EXPECT_EQ(Named("spectral_gap", summary.estimates).value,
                RelaxationSpectrum::Get().Gap().value);
    }
    const PointSummary summary = answered(epsilon, Model::kSpectrum);
    const std::vector<Estimate>& limit = summary.estimates;
    std::vector<std::string> names = {"spectral_gap", "isolated_rate_2", "isolated_rate_3",
                                      "isolated_rate_4", "isolated_rate_5"};
    if (epsilon) names.insert(names.begin(), "decay_integral");
    if (exists) names.insert(names.begin(), "relaxation_time");
    EXPECT_EQ(NamesOf(summary), names);
    EXPECT_EQ(limit[0].limit, limit[0].value);
    const auto& rates = RelaxationSpectrum::Get().IsolatedRates();
    for (size_t i = 0; i < rates.size(); ++i) {
      EXPECT_EQ(limit.at(limit.size() - rates.size() + i).value, rates[i].value);
    }
    if (!epsilon) {
      const double unit = MeanFreeTimesOf(PaperGeometry(0.1)).ball_piston / 4;
      EXPECT_NEAR(limit[0].value / unit, 2.165550673728, 1e-11);
      EXPECT_LT(*limit[0].standard_error / unit, 1e-10);
    } else if (exists) {
      EXPECT_NEAR(limit[1].value, limit[0].value * (*epsilon - kMeanPistonEnergy), 1e-9);
    }
  }
}

// The spectrum gives the part beyond the window, which is small.
TEST(EnergyRelaxation, WindowContainsNearlyAllOfTheLimitsIntegral) {
  for (const std::optional<double> epsilon : {std::optional<double>(), {0.01}, {0.4}}) {
    const EnergyRelaxation relaxation = RelaxationAt(0.01, epsilon);
    BlockResult nothing_but_the_remainder = relaxation.Empty();
    nothing_but_the_remainder.samples = 2;
    nothing_but_the_remainder.moments[0].Add(0);
    const Estimate remainder = *relaxation.Table().front().Of(nothing_but_the_remainder);
    EXPECT_NE(remainder.value, 0);
    EXPECT_LT(std::fabs(remainder.value / *remainder.limit), 0.01);
  }
}

TEST(EnergyRelaxation, CurveOfTheLimitMatchesTheSpectrum) {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  const double unit = MeanFreeTimesOf(PaperGeometry(0.1)).ball_piston / 4;
  const Curve correlation = RelaxationAt(0.1).CurveOfLimit();
  const Curve decay = RelaxationAt(0.1, 0.4).CurveOfLimit();
  EXPECT_EQ(correlation.name, "energy_autocorrelation");
  EXPECT_EQ(decay.name, "mean_energy");
  ASSERT_EQ(correlation.points.size(), kLags);
  ASSERT_EQ(decay.points.size(), kLags);
  for (size_t i = 0; i < kLags; ++i) {
    const double time = decay.points[i].at;
    EXPECT_NEAR(time / unit, 4 * kWindowTimes * static_cast<double>(i) / (kLags - 1), 1e-7);
    EXPECT_NEAR(correlation.points[i].value, spectrum.Autocorrelation(time / unit).value, 1e-13);
    EXPECT_NEAR(decay.points[i].value, spectrum.MeanEnergy(0.4, time / unit).value, 1e-13);
  }
  EXPECT_EQ(decay.points[0].limit, 0.4);
}

TEST(EnergyRelaxation, LawsRequireAnInitialEnergy) {
  EXPECT_TRUE(RelaxationAt(0.1).Empty().histograms.empty());
  EXPECT_TRUE(RelaxationAt(0.1).ProbabilitiesOfLimit().empty());
  const PointSummary summary =
      RunPoint(SpecOf(&kEnergyRelaxation, PaperPoint(0.1, 0.1), {}, Model::kSpectrum));
  ASSERT_EQ(summary.histograms.size(), kLawLags.size());
  EXPECT_TRUE(summary.histograms[0].histogram.counts.empty());
}

}  // namespace
}  // namespace ballpiston
