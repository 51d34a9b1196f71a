// Many gases in vector lanes. Between its exchanges a ball's path does not depend on the pistons.
// In each time window all balls of a gas fly ahead, many at once (lane_visits.h). Every visit of a
// ball to a piston's reach is compared with the piston's position, a triangle wave in time. The
// first visit in which they meet has the ball's next collision. A queue holds the window's
// collisions in the order of time. An exchange changes the path of its ball and the motion of its
// piston. So this ball flies the rest of the window again; so does the other ball of the piston, if
// it comes within the piston's reach. All other collisions stay valid.
//
// Replicas are independent gases of one geometry. Each goes one step, to its next event or to its
// next window; then the balls that have to fly in all replicas fly together. So small gases fill
// the lanes. A replica's numbers do not depend on the number of replicas or on the windows.
//
// Times of a replica count from an origin, which moves on by the same period again and again. So
// the rounding of times and of paths does not grow with the time since the start.
// Properties, each with the test that bears its name:
//   1. AgreesWithTheReferenceEventByEvent, until the rounding errors have grown.
//   2. CallsAndNeighboursDoNotChangeTheBits.  3. KeepsItsEnergyOverMillionsOfHits.
//   4. BallsThatMeetPistonsInTipsStayInTheirCells.
//   5. AnEscapedBallStopsAndCountsOnce.
//   6. PistonsKeepTheirMotionWhenTheOriginMoves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/billiard/piston_wave.h"
#include "core/gas/event_queue.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/gas/gas_state.h"
#include "core/gas/lane_visits.h"
#include "core/gas/thermal_walls.h"

namespace ballpiston {

class LaneGas : public GasRun {
 public:
  LaneGas(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas);

  bool AdvanceToward(double time) override;
  GasState StateOf(size_t replica) const override;

 private:
  // Its times count from `origin`.
  struct Replica {
    ThermalWalls walls;
    GasMeter* meter;
    EventQueue queue;  // the balls' collisions in the window, then arrivals at the thermal walls
    uint32_t first_ball;
    uint32_t first_piston;
    double origin = 0;
    double now = 0;    // all events before this time are done
    double end = 0;    // of the window
    size_t begun = 0;  // bodies that have begun the window: pistons, then balls
  };

  GasBall BallNow(const Replica& replica, uint32_t ball) const;
  GasPiston PistonNow(const Replica& replica, uint32_t piston) const;
  void Add(GasStart start);
  void Place(const GasBall& ball);
  void Place(const GasPiston& piston);
  void FindPistons(uint32_t ball);
  void ChooseWindow();

  void Step();
  bool Step(Replica& replica);
  void BeginWindow(Replica& replica);
  void BeginBodies(Replica& replica);
  void MoveOriginOfBall(uint32_t ball);
  void MoveOriginOfPiston(Replica& replica, uint32_t piston);

  void Order(const Replica& replica, uint32_t number);
  void OrderVisitor(const Replica& replica, uint32_t number, Direction direction);
  void FlyOrders();
  void Arrive(const FlightOrder& order);
  void Stop(const Replica& replica, const FlightOrder& order);

  void FindArrival(Replica& replica, uint32_t piston);
  void Handle(Replica& replica, size_t body);
  void Exchange(Replica& replica, uint32_t ball);
  void LeaveThermalWall(Replica& replica, uint32_t piston);

  size_t BodiesOfAReplica() const { return balls_each_ + pistons_each_; }
  Replica& ReplicaOf(uint32_t ball) { return replicas_[ball / balls_each_]; }

  GasInTime gas_;
  std::unique_ptr<FlightsAhead> lanes_;
  uint32_t balls_each_;  // of a replica
  uint32_t pistons_each_;
  double exchange_rate_;
  double mean_flight_;
  double period_;      // of the origin's moves
  double window_ = 0;  // of time
  std::vector<Replica> replicas_;
  double time_ = 0;                  // to which all replicas go
  std::vector<uint32_t> active_;     // replicas that have not come there
  std::vector<FlightOrder> orders_;  // of balls that fly now
};

}  // namespace ballpiston
