#include "core/sampling/collision_surface.h"

#include "core/closed_form/pair_measures.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

struct Case {
  double rho;
  double share;  // of the bound on delta
};

class CollisionSurface : public testing::TestWithParam<Case> {
 protected:
  PairGeometry geometry_ = GeometryAtShare(GetParam().rho, GetParam().share);
};

TEST_P(CollisionSurface, PointsLieInTheReachablePartOfTheCell) {
  CounterRandom random(1, 0, 0);
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector2d point = UniformOnCollisionSurface(geometry_, random);
    ASSERT_TRUE(InsideCell(geometry_, point, 1e-15));
    ASSERT_GE(point.x(), geometry_.piston_left() - 1e-16);
    ASSERT_LE(point.x(), geometry_.tip());
  }
}

// The mean depth t is the integral of t g(t) over that of g(t); taken by Simpson's rule from
// HalfHeight, whose own area is compared with the closed form. 5 standard errors: false alarms
// 1e-6.
TEST_P(CollisionSurface, DepthHasTheDensityOfTheHalfHeight) {
  constexpr int kCells = 2000;
  const double step = geometry_.delta() / kCells;
  double area = 0, first = 0, second = 0;
  for (int i = 0; i <= kCells; ++i) {
    const double t = i * step, weight = (i == 0 || i == kCells ? 1 : 2 + 2 * (i % 2)) * step / 3;
    const double g = geometry_.HalfHeight(t);
    area += weight * g;
    first += weight * g * t;
    second += weight * g * t * t;
  }
  // The surface is tilted by 45 degrees over the region of area 2 * integral of g.
  // Simpson's rule loses digits where the half-height's slope grows without bound (rho -> 1/2).
  EXPECT_NEAR(area * 2 * M_SQRT2 / Measures(geometry_).area_ball_piston, 1, 1e-5);
  CounterRandom random(2, 0, 0);
  Moments depth, square, height;
  for (int i = 0; i < 200'000; ++i) {
    const Eigen::Vector2d point = UniformOnCollisionSurface(geometry_, random);
    const double t = geometry_.tip() - point.x();
    depth.Add(t);
    square.Add(t * t);
    height.Add(point.y() / geometry_.HalfHeight(t));
  }
  EXPECT_NEAR(depth.mean, first / area, 5 * *depth.StandardError());
  EXPECT_NEAR(square.mean, second / area, 5 * *square.StandardError());
  EXPECT_NEAR(height.mean, 0, 5 * *height.StandardError());
  EXPECT_NEAR(*height.Variance(), 1.0 / 3, 5 * std::sqrt(4.0 / 45 / 200'000));
}

INSTANTIATE_TEST_SUITE_P(Geometries, CollisionSurface,
                         testing::Values(Case{0.5 + 1e-6, 1}, Case{0.5 + 1e-6, 0.01},
                                         Case{kPaperRho, 1}, Case{kPaperRho, 0.1}, Case{0.7, 1},
                                         Case{0.7, 0.01}));

}  // namespace
}  // namespace ballpiston
