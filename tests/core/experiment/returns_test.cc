#include "core/experiment/returns.h"

#include "core/billiard/orbits.h"
#include "core/experiment/expected_returns.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

TEST(ReturnOrbit, AnEscapedOrbitCountsAsAnEscapeOnly) {
  const ReturnStarts starts = {kPaperPair, 0.125, 1, {.seed = 1, .stream = 2}};
  const BlockResult empty = {.moments = std::vector<Moments>(1)};
  BlockOrbits<ReturnOrbit, ReturnStarts> orbits(starts, {.samples = 2}, empty);
  Collision collision;
  collision.state = orbits.Start(0);
  collision.state.ball_speed *= 1 + 1e-10;
  orbits.Collide(0, collision);
  collision.escaped = true;
  collision.state.ball_speed = 7;
  EXPECT_EQ(orbits.Collide(1, collision), AfterCollision::kEnd);
  const BlockResult result = orbits.Result();
  EXPECT_EQ(result.samples, 1u);
  EXPECT_EQ(result.moments[0].count, 1u);
  EXPECT_EQ(result.health.escapes, 1u);
  EXPECT_NEAR(result.health.max_energy_error, 1.5e-10, 1e-11);
}

TEST(ReturnTimes, SurvivalIsTheShareOfLaterHits) {
  for (const int late : {0, 100}) {  // no measured return is later, but some of the next may be
    Histogram times = EmptyReturnTimes(1);
    for (int i = 0; i < 400; ++i) times.Add(i < late ? 100 : 0.05);
    const Curve curve = SurvivalCurve(times, 1);
    const double share = (late + 0.5) / 401;  // that the error assumes
    ASSERT_EQ(curve.points.size(), kReturnTimeBins);
    EXPECT_EQ(curve.points[0].value, 1);
    EXPECT_EQ(curve.points[0].standard_error, 0);
    for (size_t i = 1; i < kReturnTimeBins; ++i) {
      const CurvePoint& point = curve.points[i];
      EXPECT_NEAR(point.at, 0.1 * static_cast<double>(i), 1e-6);
      EXPECT_NEAR(*point.limit, std::exp(-0.1 * static_cast<double>(i)), 1e-12);
      EXPECT_EQ(point.value, late / 400.0);
      // Decided by the expected hits, not by those that were measured.
      const bool is_known = 400 * *point.limit * (1 - *point.limit) >= 50;
      ASSERT_EQ(point.standard_error.has_value(), is_known) << i;
      if (!is_known) continue;
      EXPECT_NEAR(*point.standard_error, std::sqrt(share * (1 - share) / 400), 1e-15);
    }
  }
}

TEST(ReturnTimes, OnlyAnExponentialLawHasALimit) {
  for (const double epsilon : {0.0, 0.125, 0.5}) {
    const PointSummary summary = RunPoint(
        SpecOf(&kFirstHit, PaperPoint(0.2, epsilon, 1), {.samples = 64}, Model::kBilliard));
    EXPECT_EQ(summary.curves[0].points[1].limit.has_value(), epsilon == 0.125);
  }
}

// The integral of the survival probability is the mean. The test uses the trapezoidal rule and
// leaves out the part beyond the last bin; both change the integral by less than 0.002 of it.
TEST(ReturnTimes, IntegralOfTheSurvivalIsTheMeanHitTime) {
  for (const double exponent : {0.0, 1.0, 10.0}) {
    const PointSummary summary = RunPoint(
        SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, exponent), {.samples = 5'000}, Model::kBilliard));
    ASSERT_EQ(summary.curves.size(), 1u);
    const Curve& curve = summary.curves[0];
    EXPECT_EQ(curve.name, "survival");
    double integral = 0;
    for (size_t i = 1; i < curve.points.size(); ++i) {
      integral += (curve.points[i].at - curve.points[i - 1].at) *
                  (curve.points[i].value + curve.points[i - 1].value) / 2;
    }
    EXPECT_NEAR(integral / summary.estimates[0].value, 1, 0.004) << exponent;
  }
}

// ---- expected_returns.h ----

// Starts are from the invariant law, exponent 1. The predictions are exact means: 5 standard
// errors, 6e-7 false alarms each.
TEST(PredictedHits, MatchReturnsAtAnEnergy) {
  const PairGeometry geometry = PaperGeometry(0.25);
  for (const double epsilon : {0.05, 0.2, 0.35, 0.45}) {
    const PredictedHits predicted = HitsPerReturn(geometry, epsilon);
    EXPECT_EQ(predicted.Events(), 1 + predicted.ball_wall + predicted.piston_wall);
    const ReturnStarts starts = {geometry, epsilon, 1, {.seed = 1, .stream = 2}};
    for (const Engine engine : kEngines) {
      Moments ball_wall, piston_wall;
      for (const auto& collisions : Recorded(
               engine, geometry, 20'000, {.start = [&](uint64_t i) { return starts.Draw(i); }})) {
        ball_wall.Add(static_cast<double>(collisions.at(0).ball_wall_hits));
        piston_wall.Add(static_cast<double>(collisions.at(0).piston_wall_hits));
      }
      EXPECT_NEAR(ball_wall.mean, predicted.ball_wall, 5 * *ball_wall.StandardError());
      EXPECT_NEAR(piston_wall.mean, predicted.piston_wall, 5 * *piston_wall.StandardError());
    }
  }
}

}  // namespace
}  // namespace ballpiston
