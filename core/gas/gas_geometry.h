// The geometry of the gas of balls and pistons: the contacts of balls with pistons, and their
// places.
//
// Cells form a lattice of `columns` x `rows`; cell b = row * columns + column contains ball b. A
// chain has a piston on every edge between neighbouring columns; a lattice also has one on every
// edge between neighbouring rows. Along y the gas is periodic. Along x it is periodic, or it ends
// at reservoirs on both sides. With reservoirs each row has one more piston, and the two outermost
// pistons of a row meet only one ball.
//
// If the cell is turned by quarter turns until a piston is on the right, its ball sees the piston
// as in a pair. Directions: 0 right, 1 up (in a lattice), 2 left, 3 down. So all of the pair's
// geometry holds, with the gas's bound on delta: rho/sqrt(2) - lambda/2.
//
// A piston has an offset from its edge, toward +x or +y, in [-reach, reach], reach = lambda/2 +
// delta.
//
// Immutable, so safe to share between threads.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/statusor.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

enum class GasEnds { kPeriodic, kReservoirs };

// Number of quarter turns from the right.
enum class Direction { kRight, kUp, kLeft, kDown };

class GasGeometry {
 public:
  // INVALID_ARGUMENT, with name, value and permitted range, unless kMinRho < rho < kMaxRho and
  // 0 < delta <= GasDeltaBound(rho) (1 + kDeltaSlack).
  static absl::StatusOr<GasGeometry> Create(double rho, double delta, const GasShape& shape,
                                            GasEnds ends);

  const PairGeometry& pair() const { return pair_; }
  const GasShape& shape() const { return shape_; }
  GasEnds ends() const { return ends_; }
  double reach() const { return pair_.lambda() / 2 + pair_.delta(); }

  int64_t balls() const { return shape_.cells(); }
  int64_t pistons() const;
  int64_t contacts() const { return shape_.contacts(); }
  int directions() const { return shape_.directions(); }
  Direction DirectionAt(int i) const {  // i < directions()
    return static_cast<Direction>(shape_.is_lattice ? i : 2 * i);
  }

  int64_t PistonOf(int64_t ball, Direction direction) const;
  // The ball that sees the piston in this direction; kNoBall beyond a reservoir.
  int64_t BallOf(int64_t piston, Direction direction) const;
  static constexpr int64_t kNoBall = -1;

  // The direction in which the ball before the piston, toward -x or -y, sees it: kRight or kUp.
  Direction DirectionTo(int64_t piston) const {
    return IsAlongX(piston) ? Direction::kRight : Direction::kUp;
  }
  bool IsAlongX(int64_t piston) const { return piston < edges_ * shape_.rows; }
  // The x of the piston's edge, in cells from the gas's left end.
  double PositionOfPiston(int64_t piston) const;

  // Positions in the whole gas, in which cell (column, row) is centred at (column, row).
  Eigen::Vector2d CentreOfCell(int64_t ball) const;
  Eigen::Vector2d MiddleOfEdge(int64_t piston) const;

 private:
  GasGeometry(const PairGeometry& pair, const GasShape& shape, GasEnds ends)
      : pair_(pair),
        shape_(shape),
        ends_(ends),
        edges_(shape.columns + (ends == GasEnds::kReservoirs ? 1 : 0)),
        per_column_(1.0 / static_cast<double>(shape.columns)),
        per_edge_(1.0 / static_cast<double>(edges_)) {}

  // n/d, rounded down, for whole n below 2^50/d.
  static int64_t Quotient(int64_t n, double inverse_of_d) {
    return static_cast<int64_t>((static_cast<double>(n) + 0.5) * inverse_of_d);
  }

  PairGeometry pair_;
  GasShape shape_;
  GasEnds ends_;
  int64_t edges_;  // of a row, with a piston that moves along x
  double per_column_;
  double per_edge_;
};

// The components of a vector of the cell after the cell is turned until `direction` points to the
// right.
inline Eigen::Vector2d SeenToward(Direction direction, const Eigen::Vector2d& v) {
  switch (direction) {
    case Direction::kUp:
      return {v.y(), -v.x()};
    case Direction::kLeft:
      return -v;
    case Direction::kDown:
      return {-v.y(), v.x()};
    case Direction::kRight:
      break;
  }
  return v;
}

// The inverse of SeenToward.
inline Eigen::Vector2d SeenFrom(Direction direction, const Eigen::Vector2d& v) {
  const bool is_across = direction == Direction::kUp || direction == Direction::kDown;
  return is_across ? Eigen::Vector2d(-SeenToward(direction, v)) : SeenToward(direction, v);
}

inline Direction Opposite(Direction direction) {
  return static_cast<Direction>((static_cast<int>(direction) + 2) % 4);
}

// +1 if the direction is that of a piston's positive offset, else -1.
inline double SignOf(Direction direction) {
  return direction == Direction::kRight || direction == Direction::kUp ? 1 : -1;
}

inline bool IsAlongX(Direction direction) {
  return direction == Direction::kRight || direction == Direction::kLeft;
}

}  // namespace ballpiston
