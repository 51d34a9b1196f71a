#include "core/sampling/invariant_measure.h"

#include "core/closed_form/pair_measures.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(FlowMeasure, StatesAreValidAndEnergiesAreBeta) {
  CounterRandom random(4, 0, 0);
  Moments u, u_squared;
  for (int i = 0; i < 100'000; ++i) {
    const PairState state = DrawFromFlowMeasure(kPaperPair, random);
    ASSERT_TRUE(InsideCell(kPaperPair, state.position));
    ASSERT_LT(state.position.x(), state.piston);
    ASSERT_LE(EnergyError(state), 1e-15);
    // ep has the law Beta(1/2, 1): u = sqrt(2 ep) is uniform on [0, 1].
    u.Add(std::fabs(state.piston_velocity));
    u_squared.Add(state.piston_velocity * state.piston_velocity);
  }
  EXPECT_NEAR(u.mean, 0.5, 5 * *u.StandardError());  // false alarms 1e-6 each
  EXPECT_NEAR(u_squared.mean, 1.0 / 3, 5 * *u_squared.StandardError());
}

// At given energies positions have the law of mu, directions are uniform, and both signs of the
// piston's velocity are equally frequent.
TEST(FlowMeasure, AtAnEnergyPositionsAndDirectionsAreUniform) {
  const PairMeasures measures = Measures(kPaperPair);
  const double left_share =
      1 - measures.cell_area * (kPaperPair.lambda() + kPaperPair.delta()) / measures.volume;
  for (const double epsilon : {0.0, 1e-300, 0.01, 0.25, 0.4, 0.5}) {
    CounterRandom random(15, 0, 0);
    Moments left, coming, cosine, sine, square;
    for (int i = 0; i < 50'000; ++i) {
      const PairState state = DrawFromFlowMeasureAt(kPaperPair, epsilon, random);
      ASSERT_TRUE(InsideCell(kPaperPair, state.position));
      ASSERT_LT(state.position.x(), state.piston);
      ASSERT_EQ(std::fabs(state.piston_velocity), std::sqrt(2 * epsilon));
      ASSERT_LE(EnergyError(state), 1e-15);
      ASSERT_NEAR(state.direction.norm(), 1, 1e-15);
      left.Add(state.piston < kPaperPair.tip() ? 1 : 0);
      coming.Add(std::signbit(state.piston_velocity) ? 1 : 0);
      cosine.Add(state.direction.x());
      sine.Add(state.direction.y());
      square.Add(state.direction.x() * state.direction.x());
    }
    // False alarms 6e-7 each.
    EXPECT_NEAR(left.mean, left_share, 5 * *left.StandardError()) << epsilon;
    EXPECT_NEAR(coming.mean, 0.5, 5 * *coming.StandardError()) << epsilon;
    EXPECT_NEAR(cosine.mean, 0, 5 * *cosine.StandardError()) << epsilon;
    EXPECT_NEAR(sine.mean, 0, 5 * *sine.StandardError()) << epsilon;
    EXPECT_NEAR(square.mean, 0.5, 5 * *square.StandardError()) << epsilon;
  }
}

// Under nu_bp the normal component w = (v3 - v1)/sqrt(2) has density 2 w: mean 2/3; the tangential
// ones are symmetric with mean square (1 - <w^2>)/2 = 1/4.
TEST(CollisionMeasure, VelocityFollowsTheCosineLaw) {
  CounterRandom random(6, 0, 0);
  Moments normal, sum_squared, v2_squared, v2;
  for (int i = 0; i < 200'000; ++i) {
    const PairState state = DrawFromCollisionMeasure(kPaperPair, random);
    ASSERT_EQ(state.position.x(), state.piston);
    ASSERT_LE(EnergyError(state), 2e-15);
    const double v1 = state.ball_speed * state.direction.x(), v3 = state.piston_velocity;
    ASSERT_GT(v3, v1);
    normal.Add((v3 - v1) / M_SQRT2);
    sum_squared.Add((v3 + v1) * (v3 + v1) / 2);
    v2.Add(state.ball_speed * state.direction.y());
    v2_squared.Add(std::pow(state.ball_speed * state.direction.y(), 2));
  }
  EXPECT_NEAR(normal.mean, 2.0 / 3, 5 * *normal.StandardError());
  EXPECT_NEAR(sum_squared.mean, 0.25, 5 * *sum_squared.StandardError());
  EXPECT_NEAR(v2_squared.mean, 0.25, 5 * *v2_squared.StandardError());
  EXPECT_NEAR(v2.mean, 0, 5 * *v2.StandardError());
}

}  // namespace
}  // namespace ballpiston
