#include "core/sampling/invariant_measure.h"

#include "core/closed_form/pair_measures.h"
#include "core/sampling/collision_surface.h"
#include "tests/core/preamble.h"
#include "tests/oracle/samples.h"

namespace ballpiston {
namespace {

// The distance from the uniform law on [0, 1] is above 2.6 in 2.7e-6 of all cases.
double DistanceToUniform(const std::vector<double>& sample) {
  return oracle::KolmogorovSmirnov(sample, std::identity());
}

double ShareOfCircle(double x, double y) { return std::atan2(y, x) / (2 * M_PI) + 0.5; }

TEST(FlowMeasure, StatesAreValidAndEnergiesAreBeta) {
  CounterRandom random(4, 0, 0);
  std::vector<double> u(200'000);
  for (double& here : u) {
    const PairState state = DrawFromFlowMeasure(kPaperPair, random);
    ASSERT_TRUE(InsideCell(kPaperPair, state.position));
    ASSERT_LT(state.position.x(), state.piston);
    ASSERT_LE(EnergyError(state), 1e-15);
    // ep has the law Beta(1/2, 1): u = sqrt(2 ep) is uniform on [0, 1].
    here = std::fabs(state.piston_velocity);
  }
  EXPECT_LT(DistanceToUniform(u), 2.6);
}

// At given energies positions have the law of mu, directions are uniform, and both signs of the
// piston's velocity are equally frequent.
TEST(FlowMeasure, AtAnEnergyPositionsAndDirectionsAreUniform) {
  const PairMeasures measures = Measures(kPaperPair);
  const double left_share =
      1 - measures.cell_area * (kPaperPair.lambda() + kPaperPair.delta()) / measures.volume;
  for (const double epsilon : {0.0, 1e-300, 0.01, 0.25, 0.4, 0.5}) {
    CounterRandom random(15, 0, 0);
    Moments left, coming;
    std::vector<double> angles(200'000);
    for (double& angle : angles) {
      const PairState state = DrawFromFlowMeasureAt(kPaperPair, epsilon, random);
      ASSERT_TRUE(InsideCell(kPaperPair, state.position));
      ASSERT_LT(state.position.x(), state.piston);
      ASSERT_EQ(std::fabs(state.piston_velocity), std::sqrt(2 * epsilon));
      ASSERT_LE(EnergyError(state), 1e-15);
      ASSERT_NEAR(state.direction.norm(), 1, 1e-15);
      left.Add(state.piston < kPaperPair.tip() ? 1 : 0);
      coming.Add(std::signbit(state.piston_velocity) ? 1 : 0);
      angle = ShareOfCircle(state.direction.x(), state.direction.y());
    }
    // False alarms 6e-7 each.
    EXPECT_NEAR(left.mean, left_share, 5 * *left.StandardError()) << epsilon;
    EXPECT_NEAR(coming.mean, 0.5, 5 * *coming.StandardError()) << epsilon;
    EXPECT_LT(DistanceToUniform(angles), 2.6) << epsilon;
  }
}

// Under nu_bp the normal component w = (v3 - v1)/sqrt(2) has density 2 w, so w^2 is uniform. The
// direction of the tangential ones, (v3 + v1)/sqrt(2) and v2, is uniform.
TEST(CollisionMeasure, VelocityFollowsTheCosineLaw) {
  CounterRandom random(6, 0, 0);
  std::vector<double> normal_squared(400'000), tangential;
  for (double& square : normal_squared) {
    const PairState state = DrawFromCollisionMeasure(kPaperPair, random);
    ASSERT_EQ(state.position.x(), state.piston);
    ASSERT_LE(EnergyError(state), 2e-15);
    const double v1 = state.ball_speed * state.direction.x(), v3 = state.piston_velocity;
    ASSERT_GT(v3, v1);
    square = (v3 - v1) * (v3 - v1) / 2;
    tangential.push_back(
        ShareOfCircle((v3 + v1) / M_SQRT2, state.ball_speed * state.direction.y()));
  }
  EXPECT_LT(DistanceToUniform(normal_squared), 2.6);
  EXPECT_LT(DistanceToUniform(tangential), 2.6);
}

// ---- collision_surface.h ----

// The depth's density is proportional to HalfHeight, whose area is compared with the closed form.
// Its distribution function is by the midpoint rule. False alarms: 2.7e-6 for each of the two laws.
TEST(CollisionSurface, DepthHasTheDensityOfTheHalfHeight) {
  constexpr size_t kCells = 20'000;
  for (const PairGeometry& geometry :
       {GeometryAtShare(0.5 + 1e-6, 1), GeometryAtShare(0.5 + 1e-6, 0.01),
        GeometryAtShare(kPaperRho, 1), GeometryAtShare(kPaperRho, 0.1), GeometryAtShare(0.7, 1),
        GeometryAtShare(0.7, 0.01)}) {
    SCOPED_TRACE(absl::StrCat("rho ", geometry.rho(), " delta ", geometry.delta()));
    const double step = geometry.delta() / kCells;
    std::vector<double> areas = {0};
    for (size_t i = 0; i < kCells; ++i) {
      areas.push_back(areas.back() +
                      geometry.HalfHeight((static_cast<double>(i) + 0.5) * step) * step);
    }
    // The surface is tilted by 45 degrees over the region of twice this area.
    EXPECT_NEAR(areas.back() * 2 * M_SQRT2 / Measures(geometry).area_ball_piston, 1, 1e-5);
    CounterRandom random(2, 0, 0);
    std::vector<double> depths(500'000), heights;
    for (double& depth : depths) {
      const Eigen::Vector2d point = UniformOnCollisionSurface(geometry, random);
      ASSERT_TRUE(InsideCell(geometry, point, 1e-15));
      ASSERT_GE(point.x(), geometry.piston_left() - 1e-16);
      ASSERT_LE(point.x(), geometry.tip());
      depth = geometry.tip() - point.x();
      heights.push_back(0.5 + 0.5 * point.y() / geometry.HalfHeight(depth));
    }
    const auto share_below = [&](double depth) {
      const double x = depth / step;
      const size_t cell = std::min(static_cast<size_t>(x), kCells - 1);
      return std::lerp(areas[cell], areas[cell + 1], x - static_cast<double>(cell)) / areas.back();
    };
    EXPECT_LT(oracle::KolmogorovSmirnov(depths, share_below), 2.6);
    EXPECT_LT(oracle::KolmogorovSmirnov(heights, std::identity()), 2.6);
  }
}

}  // namespace
}  // namespace ballpiston
