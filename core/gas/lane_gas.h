// Many gases in vector lanes. Between its exchanges a ball's path does not depend on the pistons.
// In each time window all balls fly ahead, many at once (lane_visits.h). Every visit of a ball
// to a piston's reach is compared with the piston's position, a triangle wave in time. The first
// visit in which they meet is the ball's next contact. A queue holds the window's contacts in the
// order of time. An exchange changes the path of its ball and the motion of its piston. So this
// ball, and the other ball of the piston, fly the rest of the window again. All other contacts stay
// valid.
//
// Replicas are independent gases of one geometry; small gases fill the lanes together. A replica's
// numbers do not depend on the number of replicas or on the windows.
//
// Times count from an origin, which moves on by the same period again and again. So the rounding of
// times and of paths does not grow with the time since the start.
// Properties, each with the test that bears its name:
//   1. AgreesWithTheReferenceEventByEvent, until the rounding errors have grown.
//   2. ManyShortCallsGiveTheBitsOfOneCall.  3. ReplicasDoNotDependOnTheirNeighbours.
//   4. EnergyIsConserved.
//   5. BallsThatMeetPistonsInTipsStayInTheirCells.
//   6. AnEscapedBallStopsAndCountsOnce.
#ifndef BALLPISTON_CORE_GAS_LANE_GAS_H_
#define BALLPISTON_CORE_GAS_LANE_GAS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <vector>

#include "core/billiard/piston_wave.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/gas/gas_state.h"
#include "core/gas/lane_visits.h"
#include "core/gas/thermal_walls.h"

namespace ballpiston {

class LaneGas : public GasRun {
 public:
  LaneGas(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas);

  bool AdvanceTo(double time, Pauses& pauses) override;

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  // A ball's contact, or an outermost piston's arrival at its thermal wall.
  struct Entry {
    double time = 0;
    uint32_t body = 0;     // the balls come first, then the pistons
    uint32_t version = 0;  // the entry is valid if the body's version is the same
    size_t meeting = 0;    // in meetings_

    bool operator>(const Entry& other) const {
      return time > other.time || (time == other.time && body > other.body);
    }
  };
  struct Replica {
    ThermalWalls walls;
    GasMeter* meter;
  };

  bool Place(Pauses& pauses);
  void PlaceBall(size_t number);
  void PlacePiston(size_t number);
  void FindPistons(uint32_t ball);
  void ChooseWindow();

  void BeginWindow(double end);
  bool FinishWindow(Pauses& pauses);
  bool MoveOrigin(Pauses& pauses);
  void MoveOriginOfBall(size_t ball);
  void MoveOriginOfPiston(size_t piston);
  void FlyNextBalls();
  void FlyAgain(std::span<const uint32_t> balls);
  bool FlyOrders(Pauses& pauses);
  void Fly(std::span<FlightOrder> orders, std::span<const FlyingBall> from);
  FlightOrder OrderFor(uint32_t ball) const;
  void Stop(FlightOrder& order);

  void FindArrival(uint32_t piston);
  void Push(Entry entry);
  void Handle(const Entry& entry);
  void Exchange(const Entry& entry);
  void LeaveThermalWall(const Entry& entry);

  Replica& ReplicaOf(uint32_t ball) { return replicas_[ball / balls_each_]; }
  uint32_t BallOf(uint32_t piston, Direction direction) const;  // kNone if there is none

  GasInTime gas_;
  uint32_t balls_each_;  // of a replica
  uint32_t pistons_each_;
  double exchange_rate_;
  double mean_flight_;
  double period_;                               // of the origin's moves
  double window_ = 0;                           // of time
  double origin_ = 0;                           // all times in here count from it
  size_t moved_balls_ = 0, moved_pistons_ = 0;  // with the origin
  std::vector<GasStart> starts_;                // until all bodies are placed
  size_t placed_balls_ = 0, placed_pistons_ = 0;
  std::vector<Replica> replicas_;
  // By ball. `from_` is the ball before the flight in which the window begins, or in which its last
  // exchange in the window is. `to_` is the ball before the flight in which the window ends.
  std::vector<FlyingBall> from_, to_;
  std::vector<uint32_t> versions_;                                        // by ball, then by piston
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;  // of the window
  std::vector<MeetingInTime> meetings_;
  std::vector<FlightOrder> orders_;  // of balls that fly now
  size_t flights_ = 0;               // that these balls fly at a time
  bool orders_are_new_ = false;      // their balls are still in from_
  size_t flown_balls_ = 0;           // in this window, or on their way
  size_t found_arrivals_ = 0;        // pistons whose arrivals in this window are found
  bool is_in_window_ = false;
  double now_ = 0;  // all events before this time are done
  double end_ = 0;  // of the window
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_LANE_GAS_H_
