#include "core/sampling/collision_surface.h"

#include "core/closed_form/pair_measures.h"
#include "tests/core/preamble.h"
#include "tests/oracle/samples.h"

namespace ballpiston {
namespace {

std::vector<PairGeometry> FromCuspsToSmallCells() {
  return {GeometryAtShare(0.5 + 1e-6, 1), GeometryAtShare(0.5 + 1e-6, 0.01),
          GeometryAtShare(kPaperRho, 1),  GeometryAtShare(kPaperRho, 0.1),
          GeometryAtShare(0.7, 1),        GeometryAtShare(0.7, 0.01)};
}

TEST(CollisionSurface, PointsLieInTheReachablePartOfTheCell) {
  for (const PairGeometry& geometry : FromCuspsToSmallCells()) {
    CounterRandom random(1, 0, 0);
    for (int i = 0; i < 10'000; ++i) {
      const Eigen::Vector2d point = UniformOnCollisionSurface(geometry, random);
      ASSERT_TRUE(InsideCell(geometry, point, 1e-15));
      ASSERT_GE(point.x(), geometry.piston_left() - 1e-16);
      ASSERT_LE(point.x(), geometry.tip());
    }
  }
}

// The depth's density is proportional to HalfHeight, whose area is compared with the closed form.
// Its distribution function is by the midpoint rule. False alarms: 2.7e-6 for each of the two laws.
TEST(CollisionSurface, DepthHasTheDensityOfTheHalfHeight) {
  constexpr size_t kCells = 20'000;
  for (const PairGeometry& geometry : FromCuspsToSmallCells()) {
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
