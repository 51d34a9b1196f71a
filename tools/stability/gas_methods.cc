// All methods of the gas, and their checked runs: a gas is checked after each event if the method
// reports all events, else through its meter, by the exchanges of a short run, and by the energies
// at the end of any run.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/closed_form/pair_measures.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "tools/flows/fixed_step_gas.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/case.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {
namespace {

constexpr double kGasEpsilon = std::numeric_limits<double>::epsilon();

// The time of so many flights of a ball of speed 1.
double TimeOf(uint64_t flights, const GasGeometry& geometry) {
  return static_cast<double>(flights) * MeanFlight(geometry.pair());
}

// ---- by events ----

// The error of a body's position is the rounding error of its time multiplied by its speed. The
// time has an ulp of error for each of the few sums between two events of the body.
double PlaceSlack(double time, double speed) {
  constexpr double kSums = 8;
  return kGasEpsilon * (kPositionUlps + kSums * time * speed);
}

// Checks every event of one gas.
//
// Between two of its events a body moves in a straight line. The watch moves every body from its
// last event to its next event and checks there that the ball is not beyond one of its pistons, and
// that the piston is not beyond the ends of its path. At a contact this check covers the whole time
// between the two events, because the gap between a ball and a piston changes linearly.
class GasWatch {
 public:
  GasWatch(const GasGeometry& geometry, const GasStart& start)
      : geometry_(geometry),
        walls_(start.walls),
        look_(geometry.pair(), kGasEpsilon),
        start_energy_(EnergyOf(start.state)) {
    const Standstill standstill(ShortFlight(geometry.pair(), kGasEpsilon),
                                LongestStandstill(geometry.pair()));
    for (const GasBall& ball : start.state.balls) balls_.push_back({ball, standstill});
    for (const GasPiston& piston : start.state.pistons) pistons_.push_back({piston});
  }

  // Checks an event of the gas. Returns false if the gas has failed and must not be continued.
  template <typename Gas>
  bool See(const GasEvent& event, const Gas& gas, Failures& failures) {
    failures.negative_times += event.time < last_;
    last_ = std::max(last_, event.time);
    if (event.kind == EventKind::kEscape) {
      ++failures.escapes;
      return false;
    }
    const uint64_t missed = failures.missed;
    LookAtWay(event, failures);
    if (failures.missed > missed) return false;
    const bool goes_on =
        event.ball < 0 || SeeBall(event, gas.BallAt(event.ball, event.time), failures);
    if (event.piston >= 0) SeePiston(event, gas.PistonAt(event.piston, event.time));
    if (event.kind == EventKind::kBallPiston) SeeExchanged(event, failures);
    return goes_on;
  }

  // dE/E of the whole gas since the start, without the energy from thermal walls.
  double EnergyError() const {
    double energy = -given_;
    for (const Ball& ball : balls_) energy += EnergyOf(ball.state);
    for (const Piston& piston : pistons_) energy += EnergyOf(piston.state);
    return energy / start_energy_ - 1;
  }

 private:
  struct Ball {
    GasBall state;
    Standstill standstill;
    double since = 0;
  };
  struct Piston {
    GasPiston state;
    double since = 0;
  };

  static size_t Index(int64_t i) { return static_cast<size_t>(i); }

  // Checks the motion up to the event, with the velocities before the event.
  void LookAtWay(const GasEvent& event, Failures& failures) const {
    if (event.ball >= 0) LookForMissed(event.ball, event.time, failures);
    if (event.piston < 0) return;
    const Piston& piston = pistons_[Index(event.piston)];
    const double velocity = piston.state.velocity;
    const double offset = piston.state.offset + velocity * (event.time - piston.since);
    const double slack = PlaceSlack(event.time, std::fabs(velocity));
    failures.beyond_walls += !(std::fabs(offset) <= geometry_.reach() + slack);
    const Direction direction = geometry_.DirectionTo(event.piston);
    for (const Direction side : {direction, Opposite(direction)}) {
      const int64_t ball = geometry_.BallOf(event.piston, side);
      if (ball != GasGeometry::kNoBall && ball != event.ball) {
        LookForMissed(ball, event.time, failures);
      }
    }
  }

  void LookForMissed(int64_t number, double time, Failures& failures) const {
    for (int i = 0; i < geometry_.directions(); ++i) {
      const Direction direction = geometry_.DirectionAt(i);
      const Piston& piston = pistons_[Index(geometry_.PistonOf(number, direction))];
      failures.missed += IsBeyond(balls_[Index(number)], direction, piston, time);
    }
  }

  bool IsBeyond(const Ball& ball, Direction direction, const Piston& piston, double time) const {
    const Eigen::Vector2d position =
        ball.state.position + ball.state.direction * (ball.state.speed * (time - ball.since));
    const double offset = piston.state.offset + piston.state.velocity * (time - piston.since);
    const double beyond = SeenToward(direction, position).x() - (0.5 + SignOf(direction) * offset);
    const double speed = ball.state.speed + std::fabs(piston.state.velocity);
    return beyond > PlaceSlack(time, speed) && beyond > look_.Slack(position, ball.state.direction);
  }

  bool SeeBall(const GasEvent& event, const GasBall& after, Failures& failures) {
    Ball& ball = balls_[Index(event.ball)];
    const double length = (event.time - ball.since) * ball.state.speed;
    ball.state = after;
    ball.since = event.time;
    if (!look_.IsInCell(after.position, failures)) return false;
    if (event.kind == EventKind::kBallWall) {
      failures.inward += look_.HeadsInward(after.position, after.direction);
    }
    return !ball.standstill.See(length, failures);
  }

  void SeePiston(const GasEvent& event, const GasPiston& after) {
    Piston& piston = pistons_[Index(event.piston)];
    if (event.kind == EventKind::kPistonWall && walls_.Has(event.piston)) {
      given_ += EnergyOf(after) - EnergyOf(piston.state);
    }
    piston = {after, event.time};
  }

  void SeeExchanged(const GasEvent& event, Failures& failures) const {
    ++failures.hits;
    ++failures.looked_back;
    const GasBall& ball = balls_[Index(event.ball)].state;
    const double piston = SignOf(event.direction) * pistons_[Index(event.piston)].state.velocity;
    const double approach = ball.speed * SeenToward(event.direction, ball.direction).x() - piston;
    failures.inward += approach > kDirectionUlps * kGasEpsilon * (ball.speed + std::fabs(piston));
  }

  GasGeometry geometry_;
  ThermalWalls walls_;  // which pistons get energy from outside
  BallWatch look_;
  std::vector<Ball> balls_;
  std::vector<Piston> pistons_;
  double start_energy_;
  double given_ = 0;  // the energy from thermal walls
  double last_ = 0;   // the time of the latest event
};

template <typename Gas>
void RunGas(const GasGeometry& geometry, const GasStart& replica, uint64_t flights,
            Failures& failures) {
  // A gas without a loop has far fewer events.
  constexpr uint64_t kMostEvents = 10'000'000;
  Gas gas(geometry, replica.state, replica.walls);
  GasWatch watch(geometry, replica);
  const double end = TimeOf(flights, geometry);
  uint64_t events = 0;
  bool goes_on = true;
  for (; goes_on && events < kMostEvents && gas.NextTime() <= end; ++events) {
    goes_on = watch.See(gas.Step(), gas, failures);
  }
  failures.loops += events == kMostEvents;
  failures.SeeEnergy(watch.EnergyError());
  if (goes_on) failures.gain.Add(watch.EnergyError());
}

// ---- by meters ----

// A neighbouring start: every number is changed by at most `most`.
GasState Moved(double most, const GasGeometry& geometry, GasState state, CounterRandom& random) {
  const auto off = [&] { return most * (2 * random.Uniform() - 1); };
  const double reach = geometry.reach();
  for (GasBall& ball : state.balls) {
    ball.position += Eigen::Vector2d(off(), off());
    ball.direction = (ball.direction + Eigen::Vector2d(off(), off())).normalized();
  }
  for (GasPiston& piston : state.pistons) {
    piston.offset = std::clamp(piston.offset + off(), -reach, reach);
  }
  return state;
}

GasMeter ByReference(const GasGeometry& geometry, const GasStart& replica, double time) {
  const auto run =
      StartGases(GasEngine::kReference, geometry, GasExchangeRate(geometry, 1), {replica});
  run->AdvanceTo(time);
  return std::move(run->meters().front());
}

double Distance(const GasMeter& a, const GasMeter& b) {
  double distance = 0;
  for (size_t i = 0; i < a.bodies(); ++i) {
    distance = std::max(distance, ErrorSize(a.Energy(i) - b.Energy(i)));
  }
  return distance;
}

// Compares the meter with the reference, from the same start and, at each scale, from `each`
// neighbouring starts.
Failures AsNeighboursTell(const GasGeometry& geometry, const GasStart& replica, double time,
                          const GasMeter& meter, const std::vector<double>& scales, int each) {
  constexpr uint64_t kNeighbourSeed = 25;
  const GasMeter middle = ByReference(geometry, replica, time);
  CounterRandom random(kNeighbourSeed, 0, 0);
  double nearest = Distance(meter, middle), spread = 0;
  for (const double scale : scales) {
    for (int i = 0; i < each; ++i) {
      GasStart moved = replica;
      moved.state = Moved(scale * kGasEpsilon, geometry, replica.state, random);
      const GasMeter other = ByReference(geometry, moved, time);
      nearest = std::min(nearest, Distance(meter, other));
      spread = std::max(spread, Distance(middle, other));
    }
  }
  Failures found;
  // Two neighbours differ by at most twice their largest difference from the middle.
  if (nearest <= 1e4 * kGasEpsilon * middle.TotalEnergy() + 2 * spread) return found;
  (meter.exchanges() < middle.exchanges() ? found.missed : found.phantoms) = 1;
  return found;
}

// Compares the meter of a replica at `time` with the meters of the reference gas, from the same
// start and from neighbouring starts. Rounding errors grow with every hit: therefore `time` is the
// duration of a few flights. A difference counts if the engine differs from all neighbours by more
// than they differ from each other. It counts as missed if the engine had fewer exchanges than the
// reference, else as a phantom.
Failures LookBack(const GasGeometry& geometry, const GasStart& replica, double time,
                  const GasMeter& meter) {
  Failures found = AsNeighboursTell(geometry, replica, time, meter, {64}, 2);  // beyond rounding
  // The middle has rounding errors too. In a tip, or for a grazing ball, an ulp decides, and two
  // neighbours are not enough.
  if (found.Total() > 0) {
    found = AsNeighboursTell(geometry, replica, time, meter, {1, 4, 16, 64}, 500);
  }
  found.looked_back = meter.exchanges();
  return found;
}

// Checks a replica at its end. Counts escapes, also if an energy is not a number, and, without
// thermal walls, the error of the energy.
Failures LookAtEnergies(const GasGeometry& geometry, const GasState& start, const GasMeter& meter) {
  bool is_valid = true;
  for (size_t i = 0; i < meter.bodies(); ++i) {
    is_valid &= meter.Energy(i) >= 0 && std::isfinite(meter.Energy(i));
  }
  Failures found = {
      .orbits = 1, .hits = meter.exchanges(), .escapes = meter.escapes() + (is_valid ? 0 : 1)};
  if (geometry.ends() == GasEnds::kPeriodic) {
    const double error = meter.TotalEnergy() / EnergyOf(start) - 1;
    found.SeeEnergy(error);
    found.gain.Add(error);
  }
  return found;
}

template <GasEngine engine>
Failures RunByMeters(const GasGeometry& geometry, std::span<const GasStart> replicas,
                     uint64_t flights) {
  constexpr uint64_t kFewFlights = 10;
  // These engines report nothing before the requested time. Gases that are not there after so many
  // calls, each of some 2 ms, count as one loop; usually 2 s are enough for kTogether gases.
  constexpr uint64_t kMostCalls = 300'000;
  const auto gases = StartGases(engine, geometry, GasExchangeRate(geometry, 1),
                                {replicas.begin(), replicas.end()});
  uint64_t calls = 0;
  const auto arrives = [&](double time) {
    while (calls++ < kMostCalls) {
      if (gases->AdvanceToward(time)) return true;
    }
    return false;
  };
  const Failures endless = {.orbits = replicas.size(), .loops = 1};
  Failures failures;
  if (engine == GasEngine::kLanes) {
    const double soon = TimeOf(std::min(kFewFlights, flights), geometry);
    if (!arrives(soon)) return endless;
    for (size_t i = 0; i < replicas.size(); ++i) {
      failures.Merge(LookBack(geometry, replicas[i], soon, gases->meters()[i]));
    }
  }
  if (!arrives(TimeOf(flights, geometry))) return endless;
  for (size_t i = 0; i < replicas.size(); ++i) {
    failures.Merge(LookAtEnergies(geometry, replicas[i].state, gases->meters()[i]));
  }
  return failures;
}

}  // namespace

std::vector<GasMethod> GasMethods() {
  return {
      {"lanes", 1, true, RunByMeters<GasEngine::kLanes>},
      {"reference", 1, true, OneByOne<RunGas<ReferenceGas>>},
      {"jump process", 1, true, RunByMeters<GasEngine::kJumps>},
      {"fixed steps of 1e-3", 0.01, false, OneByOne<RunGas<FixedStepGas>>},
  };
}

}  // namespace ballpiston::stability
