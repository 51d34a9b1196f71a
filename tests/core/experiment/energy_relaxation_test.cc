#include "core/experiment/energy_relaxation.h"

#include "core/billiard/event_flow.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/random_stream.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecOfOrbits(const PointParameters& point, Model model, int64_t samples) {
  return SpecOf(&kEnergyRelaxation, point, {.samples = samples}, model);
}

EnergyRelaxation RelaxationAt(double delta, std::optional<double> epsilon = {}) {
  return {PaperGeometry(delta), PaperPoint(delta, epsilon)};
}

// A pulse, from 1/6 + a to 1/6 - a and back, over half the window: the product over a lag is -a^2
// across one jump, otherwise a^2. The width of the pulse shows whether the lags have their length.
TEST(EnergyRelaxation, CorrelationsOfAPulseMatchHandCalculation) {
  constexpr double kOff = 0.1;
  constexpr size_t kJumpAtLag = 64;  // of the 128 steps of origins
  constexpr size_t kWidth = (kLags - 1) / 2;
  const EnergyRelaxation relaxation = RelaxationAt(0.1);
  const double lag = 4 * relaxation.unit() * kWindowTimes / (kLags - 1);
  StepFunction energy(kMeanPistonEnergy + kOff);
  // Half a lag more, so that rounding does not decide on which side a sample lies.
  energy.Add((kJumpAtLag - 0.5) * lag, kMeanPistonEnergy - kOff);
  energy.Add(kWidth * lag, kMeanPistonEnergy + kOff);
  const std::vector<double> values = relaxation.Measure(energy);
  const double origins = kOriginTimes / kWindowTimes * (kLags - 1) / 2;
  for (size_t i = 0; i < kLags; ++i) {
    const size_t across = 2 * (std::min(i, kWidth) / 2);  // of the even origins, either jump
    EXPECT_NEAR(values[1 + i],
                45 * kOff * kOff * (origins - 2 * static_cast<double>(across)) / origins, 1e-12)
        << i;
  }
  // Continuously: at a lag s each jump is crossed from origins within a time min(s, width).
  const double tau = 4 * relaxation.unit();
  EXPECT_NEAR(values[0],
              45 * kOff * kOff * kWindowTimes * tau * (1 - 1.5 * kWindowTimes / kOriginTimes),
              1e-9 * tau);
}

// The test follows an orbit with the reference flow, at the times of the curve.
TEST(EnergyRelaxation, OrbitsMatchTheReferenceFlow) {
  for (const double epsilon : {0.01, 0.3, 0.5}) {
    const PointParameters point = PaperPoint(0.2, epsilon);
    const EnsembleSpec spec = SpecOfOrbits(point, Model::kBilliardReference, 1);
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

// Around 1/6 the ratio to epsilon - 1/6 has no meaning, but the integral does.
TEST(EnergyRelaxation, RelaxationTimeExistsAwayFromTheMeanEnergy) {
  const auto by_spectrum = [](const std::optional<double>& epsilon) {
    return RunPoint(SpecOf(&kEnergyRelaxation, PaperPoint(0.1, epsilon), {}, Model::kSpectrum))
        .estimates;
  };
  for (const std::optional<double> epsilon :
       {std::optional<double>(), std::optional(0.0), std::optional(0.12), std::optional(0.2)}) {
    EXPECT_TRUE(HasRelaxationTime(epsilon));
    const std::vector<Estimate> limit = by_spectrum(epsilon);
    EXPECT_EQ(limit[0].name, "relaxation_time");
    EXPECT_GT(limit[0].value, 0);
    EXPECT_EQ(limit[0].limit, limit[0].value);
    EXPECT_EQ(limit[1].name, epsilon ? "decay_integral" : "spectral_gap");
    if (!epsilon) continue;
    EXPECT_NEAR(limit[1].value, limit[0].value * (*epsilon - kMeanPistonEnergy), 1e-9);
    EXPECT_EQ(limit[2].name, "spectral_gap");
  }
  for (const double epsilon : {0.121, 1.0 / 6, 0.199}) {
    EXPECT_FALSE(HasRelaxationTime(epsilon));
    const std::vector<Estimate> limit = by_spectrum(epsilon);
    EXPECT_EQ(limit[0].name, "decay_integral");
    EXPECT_TRUE(std::isfinite(limit[0].value));
    EXPECT_EQ(limit[1].name, "spectral_gap");
  }
}

TEST(EnergyRelaxation, ARemarkSaysWhyThereIsNoRelaxationTime) {
  for (const Model model : {Model::kSpectrum, Model::kMarkov, Model::kBilliard}) {
    const Target target = model == Model::kSpectrum ? Target{} : Target{.samples = 64};
    for (const auto& [epsilon, remarks] : {std::pair(0.1, 0u), std::pair(0.15, 1u)}) {
      const PointSummary summary =
          RunPoint(SpecOf(&kEnergyRelaxation, PaperPoint(0.1, epsilon), target, model));
      ASSERT_EQ(summary.remarks.size(), remarks);
      EXPECT_THAT(summary.remarks, Each(StartsWith("there is no relaxation_time")));
    }
  }
}

// The spectrum gives the part beyond the window, which is small.
TEST(EnergyRelaxation, WindowContainsNearlyAllOfTheLimitsIntegral) {
  for (const double delta : {0.2, 0.01}) {
    for (const std::optional<double> epsilon :
         {std::optional<double>(), std::optional(0.01), std::optional(0.4)}) {
      const EnergyRelaxation relaxation = RelaxationAt(delta, epsilon);
      BlockResult nothing_but_the_remainder;
      nothing_but_the_remainder.samples = 2;
      nothing_but_the_remainder.moments.resize(1 + kLags);
      nothing_but_the_remainder.moments[0].Add(0);
      const Estimate remainder = *relaxation.Table().front().Of(nothing_but_the_remainder);
      EXPECT_NE(remainder.value, 0);
      EXPECT_LT(std::fabs(remainder.value / *remainder.limit), 0.01);
    }
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
  const EnsembleSpec limit = SpecOfOrbits(PaperPoint(0.1, 0.1), Model::kSpectrum, 1);
  const PointSummary summary = PointExperiment::Create(limit, 0)->Summarize({});
  ASSERT_EQ(summary.histograms.size(), kLawLags.size());
  EXPECT_TRUE(summary.histograms[0].histogram.counts.empty());
}

}  // namespace
}  // namespace ballpiston
