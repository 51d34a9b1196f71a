#include "core/closed_form/pair_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"
#include "gtest/gtest.h"
#include "tests/core/geometries.h"
#include "tests/oracle/measures_by_quadrature.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

using std::numbers::sqrt2;

constexpr double kRadii[] = {0.5 + 1e-12, 0.5 + 1e-6, 0.501, kPaperRho,
                             0.6,         0.65,       0.7,   kMaxRho - 1e-7};

double WorstError(const PairMeasures& m, const PrintedMeasures<Quad>& exact) {
  return std::max({RelativeError(m.eta, exact.eta), RelativeError(m.cell_area, exact.cell_area),
                   RelativeError(m.volume, exact.volume),
                   RelativeError(m.area_ball_piston, exact.area_ball_piston),
                   RelativeError(m.area_ball_wall, exact.area_ball_wall),
                   RelativeError(m.area_piston_wall, exact.area_piston_wall)});
}

double ErrorOfMeasures(double rho, double delta) {
  return WorstError(Measures(GeometryOf(rho, delta)), oracle::MeasuresByQuadrature(rho, delta));
}

// A check of the oracle: it agrees with the printed formulas where these keep their digits.
TEST(PairMeasures, QuadratureAgreesWithThePrintedFormulas) {
  for (double rho : {0.51, kPaperRho, 0.6, 0.69}) {
    const double delta = 0.3 * PairDeltaBound(rho);
    const auto printed = MeasuresAsPrinted(Quad{rho}, Quad{delta}, QuadPi());
    const auto quadrature = oracle::MeasuresByQuadrature(rho, delta);
    // 34 digits less the three that the printed formulas lose at the smallest cell.
    const auto agree = [](Quad a, Quad b) { return std::abs(static_cast<double>((a - b) / b)); };
    EXPECT_LT(agree(quadrature.eta, printed.eta), 1e-28);
    EXPECT_LT(agree(quadrature.cell_area, printed.cell_area), 1e-28);
    EXPECT_LT(agree(quadrature.volume, printed.volume), 1e-28);
    EXPECT_LT(agree(quadrature.area_ball_piston, printed.area_ball_piston), 1e-28);
    EXPECT_LT(agree(quadrature.area_ball_wall, printed.area_ball_wall), 1e-28);
    EXPECT_LT(agree(quadrature.area_piston_wall, printed.area_piston_wall), 1e-28);
  }
}

TEST(PairMeasures, AccurateAtRandomGeometries) {
  std::mt19937_64 random(20240601);
  std::uniform_real_distribution<double> rho_exponent(-10, -0.01);
  std::uniform_real_distribution<double> delta_exponent(-12, -0.001);
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const double rho = 0.5 + (kMaxRho - 0.5) * std::pow(10, rho_exponent(random));
    const double delta = PairDeltaBound(rho) * std::pow(10, delta_exponent(random));
    worst = std::max(worst, ErrorOfMeasures(rho, delta));
  }
  RecordProperty("worst_relative_error", std::to_string(worst * 1e15) + "e-15");
  EXPECT_LE(worst, kPairMeasuresRelativeError);
}

TEST(PairMeasures, AccurateWhereTheCellVanishes) {
  for (double gap : {1e-2, 1e-3, 1e-5, 1e-7, 1e-10}) {
    for (double fraction : {1.0, 0.9, 1e-3, 1e-6}) {
      const double rho = kMaxRho - gap;
      EXPECT_LE(ErrorOfMeasures(rho, fraction * PairDeltaBound(rho)), kPairMeasuresRelativeError)
          << gap << " " << fraction;
    }
  }
}

TEST(PairMeasures, AccurateAtTheBound) {
  std::mt19937_64 random(20240602);
  std::uniform_real_distribution<double> rho_exponent(-15.5, -0.01);
  for (int i = 0; i < 100; ++i) {
    const double rho = 0.5 + (kMaxRho - 0.5) * std::pow(10, rho_exponent(random));
    if (rho == 0.5) continue;
    EXPECT_LE(ErrorOfMeasures(rho, PairDeltaBound(rho)), kPairMeasuresRelativeError) << rho - 0.5;
  }
}

TEST(PairMeasures, AccurateAtTheSmallestRadius) {
  const double rho = std::nextafter(0.5, 1.0);
  for (double fraction : {1.0, 1 - 0x1p-53, 1 - 1e-12, 0.5, 1e-6, 1e-12}) {
    EXPECT_LE(ErrorOfMeasures(rho, fraction * PairDeltaBound(rho)), kPairMeasuresRelativeError)
        << fraction;
  }
}

TEST(PairMeasures, PistonAtTheBoundHalvesTheCell) {
  for (double rho : kRadii) {
    const PairMeasures m = Measures(GeometryOf(rho, PairDeltaBound(rho)));
    EXPECT_NEAR(m.area_ball_piston / sqrt2 / m.cell_area, 0.5, kPairMeasuresRelativeError) << rho;
    EXPECT_NEAR(m.eta / PairDeltaBound(rho), 2, 1e-9) << rho;  // slope 1/lambda at lambda -> 0
  }
}

TEST(PairMeasures, PistonWallAreaIsTwoCellsMinusTheProjection) {
  for (double rho : kRadii) {
    const PairMeasures m = Measures(GeometryOf(rho, 0.7 * PairDeltaBound(rho)));
    EXPECT_NEAR((m.area_piston_wall + m.area_ball_piston / sqrt2) / m.cell_area, 2,
                2 * kPairMeasuresRelativeError);
  }
}

TEST(PairMeasures, VolumeGrowsByThePistonWallArea) {
  for (double rho : {0.501, kPaperRho, 0.6, 0.7}) {
    const double delta = 0.6 * PairDeltaBound(rho);
    const double step = 1e-4 * delta;
    const double slope = (Measures(GeometryOf(rho, delta + step)).volume -
                          Measures(GeometryOf(rho, delta - step)).volume) /
                         (2 * step);
    // Central difference: third derivative times step^2 is 1e-8, rounding 1e-16/1e-4.
    EXPECT_NEAR(slope / Measures(GeometryOf(rho, delta)).area_piston_wall, 1, 1e-7) << rho;
  }
}

TEST(PairMeasures, RareCollisionsSeeAWedge) {
  for (double rho : {0.501, kPaperRho, 0.6, 0.7}) {
    for (double delta : {1e-8, 1e-12, 1e-100}) {
      const double area = Measures(GeometryOf(rho, delta)).area_ball_piston;
      // The next order is delta/lambda, of which lambda >= 0.06 here.
      EXPECT_NEAR(area / delta / delta / (sqrt2 * Lambda(rho)), 1, 1e-14 + 40 * delta);
    }
  }
}

TEST(PairMeasures, CellAreaMatchesMeasures) {
  for (double rho : kRadii) {
    EXPECT_EQ(CellArea(rho), Measures(GeometryOf(rho, 0.5 * PairDeltaBound(rho))).cell_area);
  }
}

}  // namespace
}  // namespace ballpiston
