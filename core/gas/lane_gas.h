// Many gases in vector lanes. Between its exchanges a ball's way does not depend on the pistons. So
// in each window of time all balls fly ahead, many at once (lane_visits.h), and every visit to
// where a piston can be is compared with that piston's place, a triangle wave in time. The first
// visit in which they meet is the ball's next contact, and the window's contacts stand in a queue
// by time. An exchange changes the way of its ball and the motion of its piston: so the ball, and
// the other ball of that piston, fly the rest of the window again. Nothing else depends on it.
//
// Replicas are gases of one geometry that know nothing of each other; small gases fill the lanes
// together. A replica's numbers do not depend on how many there are, nor on the windows.
// Properties, each with the test that bears its name:
//   1. AgreesWithTheReferenceEventByEvent, until rounding has grown too large.
//   2. ManyShortCallsGiveTheBitsOfOne.  3. ReplicasDoNotDependOnTheirNeighbours.  4. EnergyStays.
//   5. BallsThatMeetPistonsInTipsStayInTheirCells.
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

  void AdvanceTo(double time) override;

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  // A ball's contact, or an outermost piston's arrival at its thermal wall.
  struct Entry {
    double time = 0;
    uint32_t body = 0;     // a ball, or a piston behind all balls
    uint32_t version = 0;  // void unless the body's version is the same
    size_t meeting = 0;    // in meetings_

    bool operator>(const Entry& other) const {
      return time > other.time || (time == other.time && body > other.body);
    }
  };
  struct Replica {
    ThermalWalls walls;
    GasMeter* meter;
  };

  void Place(const GasState& state);
  void FindPistons();
  void ChooseWindow(double exchange_rate);

  void AdvanceWindow();  // to end_
  void FlyAll();
  void FlyAgain(std::span<const uint32_t> balls);
  void FlyOrders(size_t flights);
  void Fly(size_t flights, std::span<FlightOrder> orders, std::span<const FlyingBall> from);
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
  double mean_flight_;
  double window_ = 0;  // of time
  std::vector<Replica> replicas_;
  // By ball. At the window's beginning, or the last exchange in it; and at its end, each before the
  // flight in which that is.
  std::vector<FlyingBall> from_, to_;
  std::vector<uint32_t> versions_;                                        // by ball, then by piston
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;  // of the window
  std::vector<MeetingInTime> meetings_;
  std::vector<FlightOrder> orders_;
  double now_ = 0;  // what was before has been done
  double end_ = 0;  // of the window
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_LANE_GAS_H_
