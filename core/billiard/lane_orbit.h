// An orbit while its ball flies in a lane: its entry into the lane, and its collision. The lanes of
// a processor (lane_orbits.cc) and of a device (core/gpu) share these functions, so that both
// report the same bits.
//
// Lengths are in cells, except where a member says that it is in the units of the lanes
// (FlightConstants::scale). A phase is in periods of the piston.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/billiard/exchange.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/longest_wait.h"
#include "core/billiard/orbits.h"
#include "core/billiard/piston_wave.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// A ball slower than this counts as at rest. The lanes cannot fly it.
inline constexpr double kAtRestInLane = 1e-18;

// A start this near to a wall may be on it.
inline constexpr double kOnAWallAtStart = 1e-9;

// An orbit since it entered at its start or its last collision.
struct LaneOrbit {
  uint64_t orbit = 0;
  double ball_speed = 1;  // at least kAtRestInLane
  double piston_speed = 0;
  double entry_phase = 0;   // as PistonWave has it
  double longest_wait = 0;  // for the piston
};

// What a lane has at the entry of an orbit, in its units.
struct LaneEntry {
  LaneFrame ball;
  double phase;   // of the piston
  double ratio;   // periods of the piston in a unit of the ball's path
  bool in_reach;  // the ball is within the piston's reach
};

// A flight in which ball and piston may have met. `ball`, `path` and `length` are in the lanes'
// units.
struct LaneFlight {
  LaneFrame ball;        // before the flight
  double phase;          // of the piston before the flight, at least 0 and below 1
  double path;           // of the ball since it entered, before the flight
  double length;         // of the flight
  uint64_t flights = 0;  // before it, since the orbit entered
};

class OrbitInLane {
 public:
  // `limit`: OrbitSource::TimeLimit.
  OrbitInLane(const PairGeometry& geometry, double scale, double limit)
      : wave_(geometry),
        longest_wait_(geometry),
        scale_(scale),
        inverse_(1 / scale),
        limit_(limit) {}

  const PistonWave& wave() const { return wave_; }

  LaneOrbit Orbit(const OrbitStart& start) const {
    return {.orbit = start.orbit,
            .ball_speed = std::max(start.state.ball_speed, kAtRestInLane),
            .piston_speed = std::fabs(start.state.piston_velocity),
            .entry_phase = wave_.Phase(start.state),
            .longest_wait = HasTimeLimit() ? limit_ : longest_wait_.From(start.state)};
  }

  // `slack` of the reach: kSlack of the lane's precision.
  LaneEntry Enter(const LaneOrbit& orbit, const PairState& state, double slack) const {
    const double period = 2 * wave_.stroke();
    return {.ball = Scaled(FrameOfBall(state.position, state.direction), scale_),
            .phase = orbit.entry_phase / period,
            .ratio = orbit.piston_speed / orbit.ball_speed / (scale_ * period),
            .in_reach = state.position.x() >= wave_.left() - slack};
  }

  // The time of an orbit whose path, in the lanes' units, is `path` since it entered.
  double TimeOf(const LaneOrbit& orbit, double path) const {
    return path / scale_ / orbit.ball_speed;
  }

  // Where ball and piston meet in the flight.
  struct Meeting {
    Collision collision;
    double way;  // of the ball in the flight
  };
  std::optional<Meeting> Meet(const LaneOrbit& orbit, const LaneFlight& flight) const {
    const LaneFrame frame = Scaled(flight.ball, inverse_);
    Collision collision;
    PairState& state = collision.state;
    state.position = PositionInCell(frame);
    state.direction = DirectionInCell(frame);
    state.direction *= OneOverLength(state.direction);
    const double phase = flight.phase * 2 * wave_.stroke();
    const double ratio = orbit.piston_speed / orbit.ball_speed;
    const double length = flight.length * inverse_;
    const std::optional<PistonWave::Collision> first = wave_.FirstCollision(
        phase, ratio, state.position.x() - wave_.left(), state.direction.x(), length);
    if (!first) return std::nullopt;
    const double path = flight.path * inverse_ + first->way;
    collision.time = path / orbit.ball_speed;
    if (collision.time > orbit.longest_wait) return Meeting{Overdue(collision.time), first->way};
    state.position += state.direction * first->way;
    state.ball_speed = orbit.ball_speed;
    state.piston = state.position.x();
    state.piston_velocity = first->piston_goes_right ? orbit.piston_speed : -orbit.piston_speed;
    collision.ball_wall_hits = flight.flights;
    collision.piston_wall_hits = wave_.Hits(orbit.entry_phase, path * ratio);
    return Meeting{collision, first->way};
  }

  // If the ball is at rest: the piston comes to it, wherever rounding puts the ball in its lane.
  std::optional<Collision> MeetAtRest(const LaneOrbit& orbit, const PairState& start) const {
    if (start.ball_speed >= kAtRestInLane) return std::nullopt;
    const std::optional<double> way =
        wave_.WayToBallAtRest(orbit.entry_phase, start.position.x() - wave_.left());
    const double time = way ? *way / orbit.piston_speed : std::numeric_limits<double>::infinity();
    if (!(time <= orbit.longest_wait)) return Overdue(time);
    Collision collision = {.state = start, .time = time};
    collision.state.ball_speed = 0;
    collision.state.piston = start.position.x();
    collision.state.piston_velocity = -orbit.piston_speed;
    collision.piston_wall_hits = orbit.entry_phase < wave_.stroke() ? 1 : 0;  // the right one
    return collision;
  }

  static Collision Escape() {
    Collision collision;
    collision.escaped = true;
    return collision;
  }
  // The orbit has waited for `time`, which is longer than permitted.
  Collision Overdue(double time) const {
    Collision collision;
    collision.time = time;
    (HasTimeLimit() ? collision.expired : collision.escaped) = true;
    return collision;
  }

 private:
  bool HasTimeLimit() const { return limit_ < std::numeric_limits<double>::infinity(); }

  PistonWave wave_;
  LongestWait longest_wait_;
  double scale_;
  double inverse_;
  double limit_;
};

}  // namespace ballpiston
