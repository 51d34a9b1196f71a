#include "core/gas/gas_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/arithmetic/number_text.h"
#include "core/geometry/paper.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/gas/gases.h"
#include "tests/support/status_matchers.h"

namespace ballpiston {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Direction kDirections[] = {Direction::kRight, Direction::kUp, Direction::kLeft,
                                     Direction::kDown};

std::vector<GasGeometry> GasesOfAllShapes() {
  std::vector<GasGeometry> gases;
  for (const char* shape :
       {"1", "2", "3", "7", "1x1", "2x1", "1x2", "2x2", "1x5", "5x1", "4x3", "3x4"}) {
    for (const GasEnds ends : {GasEnds::kPeriodic, GasEnds::kReservoirs}) {
      gases.push_back(GasOf(kPaperRho, 0.1, shape, ends));
    }
  }
  return gases;
}

std::string NameOf(const GasGeometry& gas) {
  return Text(gas.shape()) + (gas.ends() == GasEnds::kPeriodic ? "" : " between reservoirs");
}

TEST(GasGeometry, PistonOfAndBallOfAreInverse) {
  for (const GasGeometry& gas : GasesOfAllShapes()) {
    for (int64_t ball = 0; ball < gas.balls(); ++ball) {
      for (int i = 0; i < gas.directions(); ++i) {
        const Direction direction = gas.DirectionAt(i);
        const int64_t piston = gas.PistonOf(ball, direction);
        ASSERT_TRUE(piston >= 0 && piston < gas.pistons()) << NameOf(gas);
        EXPECT_EQ(gas.BallOf(piston, direction), ball) << NameOf(gas) << " piston " << piston;
        EXPECT_EQ(gas.IsAlongX(piston), IsAlongX(direction));
      }
    }
  }
}

TEST(GasGeometry, EveryPistonHasItsTwoBalls) {
  for (const GasGeometry& gas : GasesOfAllShapes()) {
    SCOPED_TRACE(NameOf(gas));
    int64_t contacts = 0, without_ball = 0;
    for (int64_t piston = 0; piston < gas.pistons(); ++piston) {
      const Direction to = gas.DirectionTo(piston);
      EXPECT_EQ(to, gas.IsAlongX(piston) ? Direction::kRight : Direction::kUp);
      for (const Direction side : {to, Opposite(to)}) {
        const int64_t ball = gas.BallOf(piston, side);
        if (ball == GasGeometry::kNoBall) {
          ++without_ball;
          continue;
        }
        ++contacts;
        ASSERT_TRUE(ball >= 0 && ball < gas.balls());
        EXPECT_EQ(gas.PistonOf(ball, side), piston);
      }
    }
    EXPECT_EQ(contacts, gas.contacts());
    EXPECT_EQ(without_ball, gas.ends() == GasEnds::kPeriodic ? 0 : 2 * gas.shape().rows);
  }
}

TEST(GasGeometry, CountsOfBallsPistonsAndContacts) {
  struct Counts {
    const char* shape;
    int64_t balls, pistons, pistons_between_reservoirs, contacts;
  };
  for (const Counts& counts : {Counts{"1", 1, 1, 2, 2}, Counts{"7", 7, 7, 8, 14},
                               Counts{"1x1", 1, 2, 3, 4}, Counts{"4x3", 12, 24, 27, 48},
                               Counts{"1x5", 5, 10, 15, 20}, Counts{"5x1", 5, 10, 11, 20}}) {
    const GasGeometry ring = GasOf(kPaperRho, 0.1, counts.shape);
    EXPECT_EQ(ring.balls(), counts.balls);
    EXPECT_EQ(ring.pistons(), counts.pistons) << counts.shape;
    EXPECT_EQ(ring.contacts(), counts.contacts);
    const GasGeometry open = GasOf(kPaperRho, 0.1, counts.shape, GasEnds::kReservoirs);
    EXPECT_EQ(open.balls(), counts.balls);
    EXPECT_EQ(open.pistons(), counts.pistons_between_reservoirs) << counts.shape;
    EXPECT_EQ(open.contacts(), counts.contacts);
  }
}

// Neighbours by their columns and rows, without the numbers of the pistons in between.
TEST(GasGeometry, NeighboursShareAPiston) {
  for (const GasGeometry& gas : GasesOfAllShapes()) {
    const auto [columns, rows, is_lattice] = gas.shape();
    for (int64_t row = 0; row < rows; ++row) {
      for (int64_t column = 0; column < columns; ++column) {
        const int64_t ball = row * columns + column;
        const bool is_last = column + 1 == columns && gas.ends() == GasEnds::kReservoirs;
        const int64_t right =
            is_last ? GasGeometry::kNoBall : row * columns + (column + 1) % columns;
        EXPECT_EQ(gas.BallOf(gas.PistonOf(ball, Direction::kRight), Direction::kLeft), right)
            << NameOf(gas);
        if (!is_lattice) continue;
        const int64_t up = (row + 1) % rows * columns + column;
        EXPECT_EQ(gas.BallOf(gas.PistonOf(ball, Direction::kUp), Direction::kDown), up)
            << NameOf(gas);
      }
    }
  }
}

// A piston on the right of a ball at x stands at x + 1/2; that of the last cell of a ring is the
// first one's.
TEST(GasGeometry, PistonsStandHalfACellFromTheirBalls) {
  for (const GasGeometry& gas : GasesOfAllShapes()) {
    for (int64_t ball = 0; ball < gas.balls(); ++ball) {
      const auto x = static_cast<double>(ball % gas.shape().columns) + 0.5;
      EXPECT_EQ(gas.PositionOfPiston(gas.PistonOf(ball, Direction::kLeft)), x - 0.5);
      const double right = gas.PositionOfPiston(gas.PistonOf(ball, Direction::kRight));
      const bool is_round =
          gas.ends() == GasEnds::kPeriodic && x + 0.5 == static_cast<double>(gas.shape().columns);
      EXPECT_EQ(right, is_round ? 0 : x + 0.5) << NameOf(gas);
      if (!gas.shape().is_lattice) continue;
      EXPECT_EQ(gas.PositionOfPiston(gas.PistonOf(ball, Direction::kUp)), x);
      EXPECT_EQ(gas.PositionOfPiston(gas.PistonOf(ball, Direction::kDown)), x);
    }
  }
}

TEST(GasGeometry, DeltaIsBoundByTheGas) {
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.6, 0.7, 0.7071}) {
    const double bound = GasDeltaBound(rho);
    for (const double delta : {std::nextafter(0.0, 1.0), 0.5 * bound, bound}) {
      ASSERT_OK_AND_ASSIGN(const GasGeometry gas,
                           GasGeometry::Create(rho, delta, {}, GasEnds::kPeriodic));
      EXPECT_EQ(gas.pair().delta(), delta);
      EXPECT_EQ(gas.pair().rho(), rho);
    }
    // Within the slack it becomes the bound.
    ASSERT_OK_AND_ASSIGN(const GasGeometry gas,
                         GasGeometry::Create(rho, bound * (1 + 9e-13), {}, GasEnds::kPeriodic));
    EXPECT_EQ(gas.pair().delta(), bound);
    for (const double delta :
         {bound * (1 + 2e-12), 1.1 * bound, 0.0, -0.1, std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_THAT(
          GasGeometry::Create(rho, delta, {}, GasEnds::kPeriodic),
          StatusIs(absl::StatusCode::kInvalidArgument,
                   AllOf(HasSubstr("delta is " + NumberText(delta)),
                         HasSubstr("0 < delta <= rho/sqrt(2) - lambda/2 = " + NumberText(bound)),
                         HasSubstr("the bound of a gas"))));
    }
  }
}

TEST(GasGeometry, ThePapersDeltaIsAccepted) {
  ASSERT_OK_AND_ASSIGN(const GasGeometry gas,
                       GasGeometry::Create(kPaperRho, 0.2, {}, GasEnds::kPeriodic));
  EXPECT_NEAR(gas.pair().delta(), 0.2, 1e-13);
}

TEST(GasGeometry, RadiiOutsideTheDomainAreRejected) {
  for (const double rho :
       {0.5, 0.3, -0.6, kMaxRho, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(
        GasGeometry::Create(rho, 0.1, {}, GasEnds::kPeriodic),
        StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("rho is " + NumberText(rho))));
  }
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

TEST(GasGeometry, SeenFromIsTheInverseOfSeenToward) {
  const Eigen::Vector2d v(0.3, -0.7);
  for (const Direction direction : kDirections) {
    EXPECT_EQ(SeenFrom(direction, SeenToward(direction, v)), v);
    EXPECT_EQ(SeenToward(direction, SeenFrom(direction, v)), v);
    EXPECT_EQ(SeenToward(Opposite(direction), v), -SeenToward(direction, v));
    EXPECT_EQ(Opposite(Opposite(direction)), direction);
    EXPECT_EQ(SignOf(direction), -SignOf(Opposite(direction)));
  }
}

// The view is turned, not mirrored: a vector 90 degrees to the left stays 90 degrees to the left.
TEST(GasGeometry, EveryPistonLiesOnTheRightAfterTurning) {
  const Eigen::Vector2d pistons[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (const Direction direction : kDirections) {
    const int quarter_turns = static_cast<int>(direction);
    EXPECT_EQ(SeenToward(direction, pistons[quarter_turns]), Eigen::Vector2d(1, 0));
    EXPECT_EQ(SeenToward(direction, pistons[(quarter_turns + 1) % 4]), Eigen::Vector2d(0, 1));
    EXPECT_EQ(SignOf(direction), pistons[quarter_turns].sum());
  }
}

}  // namespace
}  // namespace ballpiston
