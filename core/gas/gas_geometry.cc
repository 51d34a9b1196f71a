#include "core/gas/gas_geometry.h"

#include <algorithm>

namespace ballpiston {

absl::StatusOr<GasGeometry> GasGeometry::Create(double rho, double delta, const GasShape& shape,
                                                GasEnds ends) {
  if (absl::Status status = ValidateRho(rho); !status.ok()) return status;
  if (absl::Status status = ValidateGasDelta(rho, delta); !status.ok()) return status;
  const double permitted = std::min(delta, GasDeltaBound(rho));
  return GasGeometry(PairGeometry::Create(rho, permitted).value(), shape, ends);
}

int64_t GasGeometry::pistons() const {
  return edges_ * shape_.rows + (shape_.is_lattice ? balls() : 0);
}

// The edge on the left of column c is edge c; the edge below row r is edge r.
int64_t GasGeometry::PistonOf(int64_t ball, Direction direction) const {
  const int64_t column = ball % shape_.columns, row = ball / shape_.columns;
  const int64_t vertical = edges_ * shape_.rows;
  switch (direction) {
    case Direction::kRight:
      return row * edges_ + (column + 1) % edges_;
    case Direction::kLeft:
      return row * edges_ + column;
    case Direction::kUp:
      return vertical + (row + 1) % shape_.rows * shape_.columns + column;
    case Direction::kDown:
      break;
  }
  return vertical + ball;
}

int64_t GasGeometry::BallOf(int64_t piston, Direction direction) const {
  if (!IsAlongX(piston)) {
    const int64_t above = piston - edges_ * shape_.rows;
    const int64_t row = above / shape_.columns, column = above % shape_.columns;
    if (direction == Direction::kDown) return above;
    return (row + shape_.rows - 1) % shape_.rows * shape_.columns + column;
  }
  const int64_t row = piston / edges_, edge = piston % edges_;
  const int64_t column = direction == Direction::kLeft ? edge : edge - 1;
  if (ends_ == GasEnds::kReservoirs && (column < 0 || column >= shape_.columns)) return kNoBall;
  return row * shape_.columns + (column + shape_.columns) % shape_.columns;
}

double GasGeometry::PositionOfPiston(int64_t piston) const {
  if (IsAlongX(piston)) return static_cast<double>(piston % edges_);
  return static_cast<double>((piston - edges_ * shape_.rows) % shape_.columns) + 0.5;
}

Eigen::Vector2d GasGeometry::CentreOfCell(int64_t ball) const {
  return {static_cast<double>(ball % shape_.columns), static_cast<double>(ball / shape_.columns)};
}

Eigen::Vector2d GasGeometry::MiddleOfEdge(int64_t piston) const {
  const double x = PositionOfPiston(piston) - 0.5;
  if (IsAlongX(piston)) return {x, static_cast<double>(piston / edges_)};
  const int64_t above = piston - edges_ * shape_.rows;
  return {x, static_cast<double>(above / shape_.columns) - 0.5};
}

}  // namespace ballpiston
