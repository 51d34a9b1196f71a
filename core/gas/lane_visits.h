// Balls fly ahead in vector lanes and find their first collision with a piston, as long as the
// pistons keep their present motion.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/billiard/cell_walls.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/piston_wave.h"
#include "core/gas/event_queue.h"
#include "core/gas/gas_geometry.h"

namespace ballpiston {

// A ball between two flights, in the lanes' units.
struct FlyingBall {
  LaneFrame frame;
  double path;       // since the ball was placed
  bool is_in_reach;  // of a piston
};

// A ball meets the piston that it sees in `direction`.
struct BallCollision {
  Eigen::Vector2d position = {0, 0};
  Eigen::Vector2d velocity = {0, 0};  // of the ball, of length 1
  double time = kNever;
  Direction direction = Direction::kRight;
  bool piston_goes_right = false;  // as the ball sees it
};

// The directions in which a ball came within reach of the piston. Each direction has eight bits, of
// which the lowest is used: a vector's mask, which has a bit for each lane, gives a ball's visits
// when it is shifted right by the lane.
using Visits = uint32_t;
inline constexpr size_t kBitsOfADirection = 8;

inline bool Has(Visits visits, Direction direction) {
  return (visits >> kBitsOfADirection * static_cast<size_t>(direction) & 1) != 0;
}

// A ball since its last exchange, its start, or the last move of the origin of time. `since` is the
// time at which its path had the length 0.
struct BallInTime {
  double since = 0;
  double speed = 0;
  double slowness = 0;                   // 1/speed
  std::array<uint32_t, 4> pistons = {};  // by direction
  Visits visits = 0;                     // in the window, until its collision or shortly after
  // Where the flight starts again if a piston changes: before the flight in which the window
  // begins, or in which the ball's last exchange in the window is.
  FlyingBall from = {};
  // The state reached so far, before a flight; at last before the one in which the window ends. It
  // stays where it was if the ball has a collision.
  FlyingBall to = {};
  BallCollision collision = {};  // its next one in the window
};

// A piston since its last change of velocity, or the last move of the origin of time. `phase` is
// that of PistonWave at that time, as seen by the ball before the piston.
struct PistonInTime {
  double since = 0;
  double speed = 0;
  double phase = 0;

  // The phase at a later time, as seen by the ball that sees the piston in direction `seen`.
  double PhaseAt(double time, Direction seen, const PistonWave& wave) const {
    return wave.Reduced(phase + (SignOf(seen) < 0 ? wave.stroke() : 0) + speed * (time - since));
  }
};

// All balls and pistons of some gases of one geometry.
struct GasInTime {
  explicit GasInTime(const GasGeometry& geometry);

  GasGeometry geometry;
  PistonWave wave;
  CellWalls<double> walls;
  double unit;  // the lanes' unit of length, in cells
  std::vector<BallInTime> balls;
  std::vector<PistonInTime> pistons;
};

// A ball that is to fly ahead and to look for its first collision between two times.
struct FlightOrder {
  uint32_t ball = 0;
  double from_time = 0;
  double until_time = 0;
  bool has_arrived = false;  // at a collision, or in the flight in which `until_time` is
  bool has_escaped = false;  // before it met a piston; its state is the last one in its cell
};

// Positions up to this distance outside a piston's reach, in cells, count as inside: rounding must
// not hide a collision.
inline constexpr double kReachSlack = 1e-11;

// A ball anywhere in the cell; it may be on a wall, or beyond one by rounding.
FlyingBall PlacedBall(const GasInTime& gas, Eigen::Vector2d position, Eigen::Vector2d direction);

// A ball's position in its cell, and its direction.
struct BallPlace {
  Eigen::Vector2d position;
  Eigen::Vector2d direction;
};
BallPlace PlaceOf(const GasInTime& gas, const LaneFrame& frame);

// The lanes in which balls fly ahead. They do not depend on the balls that flew before.
class FlightsAhead {
 public:
  virtual ~FlightsAhead() = default;
  // Flies some flights of each ball, from its state `to`. If the ball meets a piston, its collision
  // is set. Otherwise `to` becomes the state reached. Visits are added. A ball's
  // numbers do not depend on other balls, or on how flights are divided between calls.
  virtual void Fly(std::span<FlightOrder> orders) = 0;
};

// The gas, in which the balls fly, must outlive the lanes.
std::unique_ptr<FlightsAhead> LanesOf(GasInTime& gas);

}  // namespace ballpiston
