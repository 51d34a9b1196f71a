// The gas in double precision, computed event by event. The faster engines are compared with it,
// and traces use it. Balls move as in the pair's reference (event_flow.h describes the stability).
// A queue holds the time of each body's next event.
//
// A body is moved only at its own events: its time is that of its last wall hit or exchange.
// Properties, each with a test of its name:
//   1. OneBallAndOnePistonMoveLikeThePair.  2. BallsStayInTheirCellsAndBeforeTheirPistons.
//   3. LongRunsKeepTheDigitsOfTheirTimes: inside, times count from an origin that moves on, so that
//      their rounding does not grow with the time since the start.
//
// Times are in cells over unit speed. One object is one gas. Not thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/billiard/cell_walls.h"
#include "core/gas/event_queue.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_state.h"
#include "core/gas/thermal_walls.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

class ReferenceGas {
 public:
  ReferenceGas(const GasGeometry& geometry, const GasState& state, ThermalWalls walls);

  // The time of the next event; infinite if there is none.
  double NextTime() const { return origin_ + queue_.First().time; }
  // Moves to the next event and resolves it. A ball that escapes, which is a defect, stops in the
  // middle of its cell, and has no more events.
  GasEvent Step();

  // At a time between the last event and the next one. Exact at the time of the last event.
  GasBall BallAt(int64_t ball, double time) const;
  GasPiston PistonAt(int64_t piston, double time) const;
  GasState StateAt(double time) const;

 private:
  // All times in here count from `origin_`.
  struct Ball {
    GasBall state;
    double time = 0;
    int last_disc = kNoDisc;  // the disc on which the ball is, if any
    CellWalls<double>::Encounter encounter = {};
    double wall_time = 0;
    // With the pistons, by direction; kNever if it hits a wall before.
    std::array<double, 4> collision_times = {kNever, kNever, kNever, kNever};
    Direction first = Direction::kRight;  // the direction of the first of them
    double origin = 0;                    // the time when all of them were found

    double CollisionTime() const { return collision_times[static_cast<size_t>(first)]; }
  };
  struct Piston {
    GasPiston state;
    double time = 0;
    double turn_time = 0;
  };

  static size_t Index(int64_t i) { return static_cast<size_t>(i); }
  size_t Place(int64_t piston) const { return Index(geometry_.balls() + piston); }  // in the queue

  void MoveOrigin();
  double FromOrigin(double time) const { return time == origin_ + now_ ? now_ : time - origin_; }
  static GasBall MovedTo(double time, const Ball& ball);
  GasPiston MovedTo(double time, const Piston& piston) const;

  void Aim(Ball& ball) const;
  void TimePiston(Piston& piston) const;
  double CollisionTime(const Ball& ball, Direction direction, const Piston& piston) const;
  void LookAround(int64_t ball);  // for its next collisions
  void LookAgain(int64_t ball, Direction direction);
  void FindCollision(Ball& ball, int64_t number, Direction direction) const;
  void Schedule(int64_t ball);
  void SchedulePiston(int64_t piston);
  GasEvent HitWall(int64_t ball);
  GasEvent Stop(int64_t ball);
  GasEvent Exchange(int64_t ball);
  GasEvent TurnPiston(int64_t piston);

  GasGeometry geometry_;
  CellWalls<double> cell_walls_;
  ThermalWalls thermal_walls_;
  std::vector<Ball> balls_;
  std::vector<Piston> pistons_;
  EventQueue queue_;  // balls, then pistons
  double origin_ = 0;
  double now_ = 0;       // the time of the last event
  uint64_t events_ = 0;  // since the origin moved
};

}  // namespace ballpiston
