#include "core/gas/gas_geometry.h"

#include "core/ensemble/parameter.h"
#include "core/gas/gas_shape.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

class EachGasGeometry : public testing::TestWithParam<std::tuple<const char*, GasEnds>> {
 protected:
  bool IsRing() const { return gas_.ends() == GasEnds::kPeriodic; }
  // The ball on the other side of the piston that the ball sees.
  int64_t Beyond(int64_t ball, Direction direction) const {
    return gas_.BallOf(gas_.PistonOf(ball, direction), Opposite(direction));
  }

  const GasGeometry gas_ = GasOf(kPaperRho, 0.1, std::get<0>(GetParam()), std::get<1>(GetParam()));
};

INSTANTIATE_TEST_SUITE_P(, EachGasGeometry,
                         testing::Combine(testing::Values("1", "2", "3", "7", "1x1", "2x1", "1x2",
                                                          "2x2", "1x5", "5x1", "4x3", "3x4"),
                                          testing::Values(GasEnds::kPeriodic,
                                                          GasEnds::kReservoirs)));

// Balls see their pistons, and pistons their balls; an outermost piston of a row has one ball.
TEST_P(EachGasGeometry, EveryContactHasItsBallAndItsPiston) {
  int64_t contacts = 0, without_ball = 0;
  for (int64_t ball = 0; ball < gas_.balls(); ++ball) {
    for (int i = 0; i < gas_.directions(); ++i) {
      const Direction direction = gas_.DirectionAt(i);
      const int64_t piston = gas_.PistonOf(ball, direction);
      ASSERT_TRUE(piston >= 0 && piston < gas_.pistons());
      EXPECT_EQ(gas_.BallOf(piston, direction), ball);
      EXPECT_EQ(gas_.IsAlongX(piston), IsAlongX(direction));
    }
  }
  for (int64_t piston = 0; piston < gas_.pistons(); ++piston) {
    const Direction to = gas_.DirectionTo(piston);
    EXPECT_EQ(to, gas_.IsAlongX(piston) ? Direction::kRight : Direction::kUp);
    for (const Direction side : {to, Opposite(to)}) {
      const int64_t ball = gas_.BallOf(piston, side);
      ++(ball == GasGeometry::kNoBall ? without_ball : contacts);
      if (ball == GasGeometry::kNoBall) continue;
      ASSERT_TRUE(ball >= 0 && ball < gas_.balls());
      EXPECT_EQ(gas_.PistonOf(ball, side), piston);
    }
  }
  EXPECT_EQ(contacts, gas_.contacts());
  EXPECT_EQ(without_ball, IsRing() ? 0 : 2 * gas_.shape().rows);
}

// By columns and rows. A piston on the right of a ball at x stands at x + 1/2; that of the last
// cell of a ring is the first one's.
TEST_P(EachGasGeometry, NeighboursShareAPistonHalfWayBetweenThem) {
  const auto [columns, rows, is_lattice] = gas_.shape();
  for (int64_t ball = 0; ball < gas_.balls(); ++ball) {
    const int64_t row = ball / columns, column = ball % columns;
    const bool is_last = column + 1 == columns;
    const auto x = static_cast<double>(column) + 0.5;
    EXPECT_EQ(Beyond(ball, Direction::kRight),
              is_last && !IsRing() ? GasGeometry::kNoBall : row * columns + (column + 1) % columns);
    EXPECT_EQ(gas_.PositionOfPiston(gas_.PistonOf(ball, Direction::kLeft)), x - 0.5);
    EXPECT_EQ(gas_.PositionOfPiston(gas_.PistonOf(ball, Direction::kRight)),
              is_last && IsRing() ? 0 : x + 0.5);
    if (!is_lattice) continue;
    EXPECT_EQ(Beyond(ball, Direction::kUp), (row + 1) % rows * columns + column);
    EXPECT_EQ(gas_.PositionOfPiston(gas_.PistonOf(ball, Direction::kUp)), x);
    EXPECT_EQ(gas_.PositionOfPiston(gas_.PistonOf(ball, Direction::kDown)), x);
  }
}

auto Created(double rho, double delta) {
  return GasGeometry::Create(rho, delta, {}, GasEnds::kPeriodic);
}

TEST(GasGeometry, DeltaIsBoundByTheGas) {
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.6, 0.7, 0.7071}) {
    const double bound = GasDeltaBound(rho);
    // Within the slack it becomes the bound.
    for (const double delta : {std::nextafter(0.0, 1.0), 0.5 * bound, bound, bound * (1 + 9e-13)}) {
      ASSERT_OK_AND_ASSIGN(const GasGeometry gas, Created(rho, delta));
      EXPECT_EQ(gas.pair().delta(), std::min(delta, bound));
      EXPECT_EQ(gas.pair().rho(), rho);
    }
    for (const double delta : {bound * (1 + 2e-12), 0.0, -0.1, HUGE_VAL, std::nan("")}) {
      EXPECT_THAT(Created(rho, delta),
                  StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("the bound of a gas")));
    }
  }
  EXPECT_NEAR(Created(kPaperRho, 0.2)->pair().delta(), 0.2, 1e-13);  // the paper's
  EXPECT_THAT(Created(0.5, 0.1),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("rho is 0.5")));
}

// At the bound the two ends of pistons on neighbouring edges touch on the disc between them.
TEST(GasGeometry, PistonsAtTheBoundTouch) {
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.6, 0.7}) {
    const GasGeometry gas = GasOf(rho, GasDeltaBound(rho), "2x2");
    const double way = gas.reach();                                // from the edge into the cell
    const double height = 0.5 - std::sqrt(rho * rho - way * way);  // half of the piston's there
    EXPECT_NEAR(0.5 - way, height, 1e-15) << rho;
    EXPECT_EQ(gas.reach(), gas.pair().lambda() / 2 + gas.pair().delta());
  }
}

// ---- gas_shape.h ----

TEST(GasShape, TextAndCodeDetermineTheShape) {
  for (const auto& [text, shape] : {std::pair<std::string, GasShape>("1", {1, 1, false}),
                                    {"12", {12, 1, false}},
                                    {"4x3", {4, 3, true}},
                                    {"7x1", {7, 1, true}},
                                    {"1x2", {1, 2, true}},
                                    {"1x1", {1, 1, true}},
                                    {"1000000", {1'000'000, 1, false}},
                                    {"1000x1000", {1000, 1000, true}},
                                    {"1x1000000", {1, 1'000'000, true}},
                                    {"1000000x1", {1'000'000, 1, true}}}) {
    EXPECT_THAT(ParseGasShape(text), IsOkAndHolds(shape)) << text;
    EXPECT_EQ(Text(shape), text);
    EXPECT_EQ(ShapeOf(CodeOf(shape)), shape) << text;
    EXPECT_EQ(CodeOf(shape), std::floor(CodeOf(shape)));
    EXPECT_LT(CodeOf(shape), 0x1p41);
    EXPECT_OK(kCells.Validate(CodeOf(shape))) << text;
    EXPECT_EQ(shape.directions(), shape.is_lattice ? 4 : 2);
    if (!shape.is_lattice) {
      EXPECT_EQ(CodeOf(shape), static_cast<double>(shape.columns));
    }
  }
}

TEST(GasShape, MalformedTextsAreRejectedAndQuoted) {
  const std::vector<std::string> malformed = absl::StrSplit(
      "|0|x|4x|x4|4x0|0x4|-3|+3| 4|4 |4\n|4X4|1e3|4.0|0x10|4x4x4|4xx4|4x-1|4 x 4|1000001|1001x1000|"
      "four|4,4|99999999999999999999|4x99999999999999999999|99999999999999999999x4|"
      "4294967296x4294967296",
      '|');
  for (const std::string& text : malformed) {
    EXPECT_THAT(ParseGasShape(text), StatusIs(absl::StatusCode::kInvalidArgument,
                                              AllOf(StartsWith("cells is \"" + text + "\""),
                                                    HasSubstr("N or NxM"), HasSubstr("1000000"))));
  }
}

}  // namespace
}  // namespace ballpiston
