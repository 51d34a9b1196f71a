// Balls fly ahead in vector lanes, past the pistons, and leave a record of every flight in which
// they may meet one of them as it moves now.
#ifndef BALLPISTON_CORE_GAS_LANE_VISITS_H_
#define BALLPISTON_CORE_GAS_LANE_VISITS_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/billiard/piston_wave.h"
#include "core/gas/gas_geometry.h"

namespace ballpiston {

// A ball between two flights, in the lanes' units: its frame (billiard/lane_frame.h), and what it
// has gone since it was placed.
struct FlyingBall {
  double h, e, c, s;
  double path;
  // Signs of the frame's compass: a and m are set for -1, ab where a and b differ.
  bool a, ab, m;
  bool is_in_reach;  // of a piston
  bool has_escaped;
};

// The lanes' unit of length, in cells.
double FlyingUnit(const GasGeometry& geometry);

// A ball anywhere in the cell.
FlyingBall PlacedBall(const GasGeometry& geometry, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& direction);

// A ball since its last exchange, or its start.
struct BallInTime {
  double since = 0;
  double speed = 0;
  double slowness = 0;                   // 1/speed
  double next_contact = 0;               // the first one that is known
  std::array<uint32_t, 4> pistons = {};  // by direction
};

// A piston since its last change. Its phase then is that of PistonWave, seen from the ball before
// it.
struct PistonInTime {
  double since = 0;
  double speed = 0;
  double phase = 0;

  // As the ball in the opposite direction sees it, at a later time.
  double PhaseAt(double time, Direction seen, const PistonWave& wave) const {
    return wave.Reduced(phase + (SignOf(seen) < 0 ? wave.stroke() : 0) + speed * (time - since));
  }
};

// A flight in which a ball may meet the piston in a direction of its cell. In cells.
struct Visit {
  double path = 0;    // of the ball before it
  double length = 0;  // its own
  Eigen::Vector2d position = {0, 0};
  Eigen::Vector2d velocity = {0, 0};  // of length 1
  uint32_t ball = 0;
  Direction piston = Direction::kRight;
};

// A ball that is to fly. `until` is the path at which it may stop, in the lanes' units.
struct FlightOrder {
  uint32_t ball = 0;
  double until = 0;
  bool has_arrived = false;
};

inline constexpr size_t kMostFlightsAhead = 12;
inline constexpr size_t kMostBallsAhead = 48;

// Places this far from a piston's reach, in cells, count as in it: rounding must not hide a
// contact.
inline constexpr double kReachSlack = 1e-11;

// All balls and pistons of some gases.
struct GasInTime {
  std::vector<BallInTime> balls;
  std::vector<PistonInTime> pistons;
};

// Flies up to kMostBallsAhead balls by up to `flights` <= kMostFlightsAhead flights each, and adds
// their visits, in the order of each ball's path. A ball that passes `until` has arrived: it is
// left before the flight in which it does. `to` may be `from`. A ball's numbers do not depend on
// the others, nor on how flights are divided between calls.
void FlyAhead(const GasGeometry& geometry, const GasInTime& gas, size_t flights,
              std::span<FlightOrder> orders, std::span<const FlyingBall> from,
              std::span<FlyingBall> to, std::vector<Visit>& visits);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_LANE_VISITS_H_
