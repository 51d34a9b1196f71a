#include "tools/stability/gas_watch.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

namespace ballpiston::stability {
namespace {

// The error of a body's position is the rounding error of its time multiplied by its speed. The
// time has an ulp of error for each of the few sums between two events of the body.
double PlaceSlack(double epsilon, double time, double speed) {
  constexpr double kSums = 8;
  return epsilon * (kPositionUlps + kSums * time * speed);
}

}  // namespace

// ---- by events ----

GasWatch::GasWatch(const GasGeometry& geometry, const GasState& start, const ThermalWalls& walls,
                   double epsilon)
    : geometry_(geometry), walls_(walls), look_(geometry.pair(), epsilon), epsilon_(epsilon) {
  const Standstill standstill(ShortFlight(geometry.pair(), epsilon),
                              LongestStandstill(geometry.pair()));
  for (const GasBall& ball : start.balls) {
    balls_.push_back({ball, standstill});
    start_energy_ += EnergyOf(ball);
  }
  for (const GasPiston& piston : start.pistons) {
    pistons_.push_back({piston});
    start_energy_ += EnergyOf(piston);
  }
}

bool GasWatch::See(const GasEvent& event, const GasBall& ball, const GasPiston& piston,
                   Failures& failures) {
  failures.negative_times += event.time < last_;
  last_ = std::max(last_, event.time);
  if (event.kind == EventKind::kEscape) {
    ++failures.escapes;
    return false;
  }
  const uint64_t missed = failures.missed;
  LookAtWay(event, failures);
  if (failures.missed > missed) return false;
  const bool goes_on = event.ball < 0 || SeeBall(event, ball, failures);
  if (event.piston >= 0) SeePiston(event, piston);
  if (event.kind == EventKind::kBallPiston) SeeExchanged(event, failures);
  return goes_on;
}

// Checks the motion up to the event, with the velocities before the event.
void GasWatch::LookAtWay(const GasEvent& event, Failures& failures) const {
  if (event.ball >= 0) LookForMissed(event.ball, event.time, failures);
  if (event.piston < 0) return;
  const Piston& piston = pistons_[Index(event.piston)];
  const double velocity = piston.state.velocity;
  const double offset = piston.state.offset + velocity * (event.time - piston.since);
  const double slack = PlaceSlack(epsilon_, event.time, std::fabs(velocity));
  failures.beyond_walls += !(std::fabs(offset) <= geometry_.reach() + slack);
  const Direction direction = geometry_.DirectionTo(event.piston);
  for (const Direction side : {direction, Opposite(direction)}) {
    const int64_t ball = geometry_.BallOf(event.piston, side);
    if (ball != GasGeometry::kNoBall && ball != event.ball) {
      LookForMissed(ball, event.time, failures);
    }
  }
}

void GasWatch::LookForMissed(int64_t number, double time, Failures& failures) const {
  for (int i = 0; i < geometry_.directions(); ++i) {
    const Direction direction = geometry_.DirectionAt(i);
    const Piston& piston = pistons_[Index(geometry_.PistonOf(number, direction))];
    failures.missed += IsBeyond(balls_[Index(number)], direction, piston, time);
  }
}

bool GasWatch::IsBeyond(const Ball& ball, Direction direction, const Piston& piston,
                        double time) const {
  const Eigen::Vector2d position =
      ball.state.position + ball.state.direction * (ball.state.speed * (time - ball.since));
  const double offset = piston.state.offset + piston.state.velocity * (time - piston.since);
  const double beyond = SeenToward(direction, position).x() - (0.5 + SignOf(direction) * offset);
  const double speed = ball.state.speed + std::fabs(piston.state.velocity);
  return beyond > PlaceSlack(epsilon_, time, speed) &&
         beyond > look_.Slack(position, ball.state.direction);
}

bool GasWatch::SeeBall(const GasEvent& event, const GasBall& after, Failures& failures) {
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

void GasWatch::SeePiston(const GasEvent& event, const GasPiston& after) {
  Piston& piston = pistons_[Index(event.piston)];
  if (event.kind == EventKind::kPistonWall && walls_.Has(event.piston)) {
    given_ += EnergyOf(after) - EnergyOf(piston.state);
  }
  piston = {after, event.time};
}

void GasWatch::SeeExchanged(const GasEvent& event, Failures& failures) const {
  ++failures.hits;
  ++failures.looked_back;
  const GasBall& ball = balls_[Index(event.ball)].state;
  const double piston = SignOf(event.direction) * pistons_[Index(event.piston)].state.velocity;
  const double approach = ball.speed * SeenToward(event.direction, ball.direction).x() - piston;
  failures.inward += approach > kDirectionUlps * epsilon_ * (ball.speed + std::fabs(piston));
}

double GasWatch::EnergyError() const {
  double energy = -given_;
  for (const Ball& ball : balls_) energy += EnergyOf(ball.state);
  for (const Piston& piston : pistons_) energy += EnergyOf(piston.state);
  return energy / start_energy_ - 1;
}

// ---- by meters ----

namespace {

constexpr double kGasEpsilon = std::numeric_limits<double>::epsilon();
constexpr uint64_t kNeighbourSeed = 25;

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
                          const GasMeter& meter, std::span<const double> scales, int each) {
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

}  // namespace

Failures LookBack(const GasGeometry& geometry, const GasStart& replica, double time,
                  const GasMeter& meter) {
  static constexpr std::array<double, 1> kBeyondRounding = {64};
  static constexpr std::array<double, 4> kScales = {1, 4, 16, 64};
  Failures found = AsNeighboursTell(geometry, replica, time, meter, kBeyondRounding, 2);
  // The middle has rounding errors too. In a tip, or for a grazing ball, an ulp decides, and two
  // neighbours are not enough.
  if (found.Total() > 0) found = AsNeighboursTell(geometry, replica, time, meter, kScales, 500);
  found.looked_back = meter.exchanges();
  return found;
}

Failures LookAtEnergies(const GasGeometry& geometry, const GasMeter& meter, double start) {
  bool is_valid = true;
  for (size_t i = 0; i < meter.bodies(); ++i) {
    is_valid &= meter.Energy(i) >= 0 && std::isfinite(meter.Energy(i));
  }
  Failures found;
  found.orbits = 1;
  found.hits = meter.exchanges();
  found.escapes = meter.escapes() + (is_valid ? 0 : 1);
  if (geometry.ends() == GasEnds::kPeriodic) {
    found.SeeEnergy(meter.TotalEnergy() / start - 1);
    found.gain.Add(meter.TotalEnergy() / start - 1);
  }
  return found;
}

}  // namespace ballpiston::stability
