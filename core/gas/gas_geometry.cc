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

// The edge on the left of column c is edge c; the edge below row r is edge r. Right and up are one
// edge further than left and down. The jump process calls this with random arguments, so there are
// no branches and no division.
int64_t GasGeometry::PistonOf(int64_t ball, Direction direction) const {
  const int64_t row = Quotient(ball, per_column_), column = ball - row * shape_.columns;
  const int64_t further = SignOf(direction) > 0 ? 1 : 0;
  const int64_t edge = column + further == edges_ ? 0 : column + further;
  const int64_t above = row + further == shape_.rows ? 0 : row + further;
  const int64_t along_y = edges_ * shape_.rows + above * shape_.columns + column;
  return ballpiston::IsAlongX(direction) ? row * edges_ + edge : along_y;
}

int64_t GasGeometry::BallOf(int64_t piston, Direction direction) const {
  const int64_t back = SignOf(direction) > 0 ? 1 : 0;
  const int64_t along_x = edges_ * shape_.rows;
  if (piston >= along_x) {
    const int64_t ball = piston - along_x - back * shape_.columns;
    return ball < 0 ? ball + balls() : ball;
  }
  const int64_t row = Quotient(piston, per_edge_), column = piston - row * edges_ - back;
  if (column < 0 || column == shape_.columns) {
    return ends_ == GasEnds::kReservoirs ? kNoBall : (row + 1) * shape_.columns - 1;
  }
  return row * shape_.columns + column;
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
