#include "core/gas/lane_gas.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/billiard/exchange.h"
#include "core/gas/hit_rates.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {
namespace {

// A ball slower than this counts as at rest. It gets this speed, at which it never reaches a wall.
constexpr double kAtRest = 1e-18;

// The fixed cost of a window for each ball, in units of a flight after an event. Flights after an
// event of the ball or of its pistons are discarded and computed again. So the total time is least
// if a ball flies ahead the root of (this number times the flights between two such events).
// Measured: twice and half the number cost up to 5 % more. With few replicas only few balls fly
// after an event, and their flights cost more.
constexpr size_t kFewReplicas = 8;
double FlightsOfAWindow(size_t replicas) { return replicas < kFewReplicas ? 2 : 8; }
constexpr double kMostFlightsInAWindow = 64;
constexpr size_t kBodiesAtATime = 1536;

// The period of the origin's moves, in mean flights. In a period the rounding of times stays far
// below kReachSlack. To move the origin costs less than a hundredth of the flights.
constexpr double kFlightsOfAPeriod = 1024;

// Nanoseconds.
constexpr double kOfAStep = 300;     // of a replica, without the flights
constexpr double kToFlyABall = 120;  // one of many
constexpr double kOfACall = 2e6;

// Hits of thermal walls for each ball and unit of time at temperature 1. An outermost piston hits
// its thermal wall at every second of its wall hits.
double ThermalHits(const GasGeometry& geometry) {
  if (geometry.ends() == GasEnds::kPeriodic) return 0;
  return HitRatesOf(geometry.pair()).of_a_piston / static_cast<double>(geometry.shape().columns);
}

// A power of two, so that any number of periods is exact.
double PeriodOf(double mean_flight) {
  return std::exp2(std::round(std::log2(kFlightsOfAPeriod * mean_flight)));
}

}  // namespace

LaneGas::LaneGas(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas)
    : GasRun(geometry, replicas),
      gas_(geometry),
      lanes_(LanesOf(gas_)),
      balls_each_(static_cast<uint32_t>(geometry.balls())),
      pistons_each_(static_cast<uint32_t>(geometry.pistons())),
      exchange_rate_(exchange_rate),
      mean_flight_(MeanFlight(geometry.pair())),
      period_(PeriodOf(mean_flight_)) {
  gas_.balls.reserve(replicas.size() * balls_each_);
  gas_.pistons.reserve(replicas.size() * pistons_each_);
  replicas_.reserve(replicas.size());
  for (GasStart& start : replicas) Add(std::move(start));
  ChooseWindow();
}

void LaneGas::Add(GasStart start) {
  const auto number = static_cast<uint32_t>(replicas_.size());
  EventQueue queue(balls_each_ + start.walls.Count());
  replicas_.push_back({.walls = std::move(start.walls),
                       .meter = &meters()[number],
                       .queue = std::move(queue),
                       .first_ball = number * balls_each_,
                       .first_piston = number * pistons_each_,
                       .begun = BodiesOfAReplica()});
  for (const GasBall& ball : start.state.balls) Place(ball);
  for (const GasPiston& piston : start.state.pistons) Place(piston);
}

void LaneGas::Place(const GasBall& ball) {
  const double speed = std::max(ball.speed, kAtRest);
  gas_.balls.push_back({.speed = speed,
                        .slowness = 1 / speed,
                        .to = PlacedBall(gas_, ball.position, ball.direction)});
  FindPistons(static_cast<uint32_t>(gas_.balls.size()) - 1);
}

void LaneGas::Place(const GasPiston& piston) {
  const PairState seen = {.piston = 0.5 + piston.offset, .piston_velocity = piston.velocity};
  gas_.pistons.push_back({.speed = std::fabs(piston.velocity), .phase = gas_.wave.Phase(seen)});
  FindArrival(replicas_.back(), static_cast<uint32_t>(gas_.pistons.size()) - 1);
}

void LaneGas::FindPistons(uint32_t ball) {
  const uint32_t first = ball / balls_each_ * pistons_each_;
  for (int i = 0; i < gas_.geometry.directions(); ++i) {
    const Direction direction = gas_.geometry.DirectionAt(i);
    const int64_t piston = gas_.geometry.PistonOf(ball % balls_each_, direction);
    gas_.balls[ball].pistons[static_cast<size_t>(direction)] =
        first + static_cast<uint32_t>(piston);
  }
}

// Chooses the window for the mean energy of the balls. The results do not depend on the window.
void LaneGas::ChooseWindow() {
  double energy = 0;
  for (const BallInTime& ball : gas_.balls) energy += ball.speed * ball.speed / 2;
  const double temperature = energy / static_cast<double>(gas_.balls.size());
  const double flights = std::sqrt(temperature) * MeanBallSpeed() / mean_flight_;
  const double events = (gas_.geometry.directions() * exchange_rate_ + ThermalHits(gas_.geometry)) *
                        std::sqrt(temperature);
  const double best =
      std::sqrt(FlightsOfAWindow(replicas_.size()) * flights / std::max(events, kAtRest));
  window_ = std::min(best, kMostFlightsInAWindow) / std::max(flights, kAtRest);
}

bool LaneGas::AdvanceToward(double time) {
  if (time > time_) {
    time_ = time;
    for (uint32_t i = 0; i < replicas_.size(); ++i) active_.push_back(i);
  }
  for (double work = 0; work < kOfACall;) {
    if (!orders_.empty()) {
      work += kToFlyABall * static_cast<double>(orders_.size() + 8);
      FlyOrders();
    } else if (!active_.empty()) {
      work += kOfAStep * static_cast<double>(active_.size());
      Step();
    } else {
      return true;
    }
  }
  return false;
}

void LaneGas::Step() {
  std::erase_if(active_, [this](uint32_t number) { return !Step(replicas_[number]); });
}

// The replica's next event, or the beginning of its next window. Returns false if the replica has
// come to time_.
bool LaneGas::Step(Replica& replica) {
  if (replica.begun < BodiesOfAReplica()) {
    BeginBodies(replica);
  } else if (const EventQueue::Entry& first = replica.queue.First(); first.time <= replica.end) {
    replica.now = first.time;
    Handle(replica, first.body);
  } else {
    replica.now = replica.end;
    if (replica.now >= time_ - replica.origin) return false;
    BeginWindow(replica);
  }
  return true;
}

// The window ends at a period's end or before it. A new period moves the origin of all bodies;
// otherwise the pistons have nothing to do.
void LaneGas::BeginWindow(Replica& replica) {
  replica.begun = pistons_each_;
  if (replica.now == period_) {
    replica.origin += period_;
    replica.now = 0;
    replica.begun = 0;
  }
  replica.end = std::min({replica.now + window_, time_ - replica.origin, period_});
  BeginBodies(replica);
}

void LaneGas::BeginBodies(Replica& replica) {
  const bool is_new_period = replica.now == 0 && replica.origin > 0;
  const size_t end = std::min(replica.begun + kBodiesAtATime, BodiesOfAReplica());
  for (; replica.begun < end; ++replica.begun) {
    const auto body = static_cast<uint32_t>(replica.begun);
    if (body < pistons_each_) {
      MoveOriginOfPiston(replica, replica.first_piston + body);
      continue;
    }
    const uint32_t ball = replica.first_ball + body - pistons_each_;
    if (is_new_period) MoveOriginOfBall(ball);
    gas_.balls[ball].from = gas_.balls[ball].to;
    Order(replica, ball);
  }
}

void LaneGas::MoveOriginOfBall(uint32_t number) {
  BallInTime& ball = gas_.balls[number];
  ball.since += ball.to.path * gas_.unit * ball.slowness - period_;
  ball.to.path = 0;
}

// An outermost piston gets a new phase at its thermal wall. Its arrival there must not be lost by
// rounding.
void LaneGas::MoveOriginOfPiston(Replica& replica, uint32_t number) {
  PistonInTime& piston = gas_.pistons[number];
  if (replica.walls.Has(number - replica.first_piston)) {
    piston.since -= period_;
    FindArrival(replica, number);
  } else {
    piston = {.since = 0,
              .speed = piston.speed,
              .phase = piston.PhaseAt(period_, Direction::kRight, gas_.wave)};
  }
}

// ---- the state at time_ ----

GasState LaneGas::StateOf(size_t number) const {
  const Replica& replica = replicas_[number];
  GasState state;
  for (uint32_t i = 0; i < balls_each_; ++i) {
    state.balls.push_back(BallNow(replica, replica.first_ball + i));
  }
  for (uint32_t i = 0; i < pistons_each_; ++i) {
    state.pistons.push_back(PistonNow(replica, replica.first_piston + i));
  }
  return state;
}

GasBall LaneGas::BallNow(const Replica& replica, uint32_t number) const {
  const BallInTime& ball = gas_.balls[number];
  const double way = (replica.now - ball.since) * ball.speed - ball.to.path * gas_.unit;
  const auto [position, direction] = PlaceOf(gas_, ball.to.frame);
  return {.position = position + direction * std::max(way, 0.0),
          .direction = direction,
          .speed = ball.speed > kAtRest ? ball.speed : 0};
}

GasPiston LaneGas::PistonNow(const Replica& replica, uint32_t number) const {
  const PistonInTime& piston = gas_.pistons[number];
  const double period = 2 * gas_.wave.stroke();
  // Rounding may give a phase just outside of [0, period).
  const double phase = piston.PhaseAt(replica.now, Direction::kRight, gas_.wave);
  const double reduced = phase < 0 ? phase + period : phase < period ? phase : phase - period;
  const double offset = gas_.wave.Position(reduced) - 0.5, reach = gas_.geometry.reach();
  return {.offset = std::clamp(offset, -reach, reach),
          .velocity = reduced < gas_.wave.stroke() ? piston.speed : -piston.speed};
}

// ---- flights ----

// The ball is to fly, from its state `to` to the window's end.
void LaneGas::Order(const Replica& replica, uint32_t number) {
  BallInTime& ball = gas_.balls[number];
  ball.collision.time = kNever;
  ball.visits = 0;
  orders_.push_back({.ball = number, .from_time = replica.now, .until_time = replica.end});
}

// The piston in this direction has changed. If the ball does not come there, its next collision is
// the same.
void LaneGas::OrderVisitor(const Replica& replica, uint32_t number, Direction direction) {
  BallInTime& ball = gas_.balls[number];
  if (!Has(ball.visits, direction)) return;
  ball.to = ball.from;
  Order(replica, number);
}

// Balls that do not arrive fly on in the next call.
void LaneGas::FlyOrders() {
  lanes_->Fly(orders_);
  std::erase_if(orders_, [this](const FlightOrder& order) {
    if (order.has_arrived) Arrive(order);
    return order.has_arrived;
  });
}

void LaneGas::Arrive(const FlightOrder& order) {
  Replica& replica = ReplicaOf(order.ball);
  if (order.has_escaped) Stop(replica, order);
  replica.queue.Set(order.ball - replica.first_ball, gas_.balls[order.ball].collision.time);
}

// A ball that has escaped rests in the middle of its cell, where no piston comes.
void LaneGas::Stop(const Replica& replica, const FlightOrder& order) {
  replica.meter->CountEscape();
  BallInTime& ball = gas_.balls[order.ball];
  ball.speed = kAtRest;
  ball.slowness = 1 / kAtRest;
  ball.since = order.from_time;
  ball.from = ball.to = PlacedBall(gas_, {0, 0}, {1, 0});
}

// ---- events ----

// An outermost piston's next arrival at its thermal wall.
void LaneGas::FindArrival(Replica& replica, uint32_t number) {
  const uint32_t local = number - replica.first_piston;
  if (!replica.walls.Has(local)) return;
  const PistonInTime& piston = gas_.pistons[number];
  const double wall = replica.walls.IsHot(local) ? 2 * gas_.wave.stroke() : gas_.wave.stroke();
  const double phase = piston.phase < wall ? piston.phase : piston.phase - 2 * gas_.wave.stroke();
  replica.queue.Set(balls_each_ + replica.walls.WallOf(local),
                    piston.since + (wall - phase) / piston.speed);
}

void LaneGas::Handle(Replica& replica, size_t body) {
  if (body < balls_each_) {
    Exchange(replica, replica.first_ball + static_cast<uint32_t>(body));
  } else {
    const int64_t piston = replica.walls.PistonAt(body - balls_each_);
    LeaveThermalWall(replica, replica.first_piston + static_cast<uint32_t>(piston));
  }
}

void LaneGas::LeaveThermalWall(Replica& replica, uint32_t number) {
  const int64_t local = number - replica.first_piston;
  const bool is_hot = replica.walls.IsHot(local);
  PistonInTime& piston = gas_.pistons[number];
  piston = {.since = replica.now,
            .speed = replica.walls.DrawSpeed(local),
            .phase = is_hot ? 0 : gas_.wave.stroke()};
  replica.meter->SetPiston(replica.origin + replica.now, local, piston.speed * piston.speed / 2);
  FindArrival(replica, number);
  const Direction toward_piston = is_hot ? Direction::kLeft : Direction::kRight;
  const int64_t ball = gas_.geometry.BallOf(local, toward_piston);
  OrderVisitor(replica, replica.first_ball + static_cast<uint32_t>(ball), toward_piston);
}

// The pair's exchange, in the cell turned until the piston is on the right.
void LaneGas::Exchange(Replica& replica, uint32_t number) {
  BallInTime& ball = gas_.balls[number];
  const BallCollision& collision = ball.collision;
  const Direction direction = collision.direction;
  const uint32_t piston_number = ball.pistons[static_cast<size_t>(direction)];
  PistonInTime& piston = gas_.pistons[piston_number];
  PairState before = {.position = SeenToward(direction, collision.position),
                      .direction = SeenToward(direction, collision.velocity),
                      .ball_speed = ball.speed > kAtRest ? ball.speed : 0};
  before.piston = before.position.x();
  before.piston_velocity = collision.piston_goes_right ? piston.speed : -piston.speed;
  const PairState after = AfterExchange(before, std::sqrt(2 * EnergyOf(before)));

  const double half_turn = SignOf(direction) < 0 ? gas_.wave.stroke() : 0;
  piston = {.since = replica.now,
            .speed = std::fabs(after.piston_velocity),
            .phase = std::fmod(gas_.wave.Phase(after) + half_turn, 2 * gas_.wave.stroke())};
  ball.speed = std::max(after.ball_speed, kAtRest);
  ball.slowness = 1 / ball.speed;
  ball.since = replica.now;
  ball.from = ball.to =
      PlacedBall(gas_, SeenFrom(direction, after.position), SeenFrom(direction, after.direction));
  const int64_t local = piston_number - replica.first_piston;
  replica.meter->Exchange({.kind = EventKind::kBallPiston,
                           .time = replica.origin + replica.now,
                           .ball = number - replica.first_ball,
                           .piston = local,
                           .direction = direction,
                           .ball_energy = after.ball_speed * after.ball_speed / 2,
                           .piston_energy = piston.speed * piston.speed / 2});
  FindArrival(replica, piston_number);
  Order(replica, number);
  const Direction opposite = Opposite(direction);
  const int64_t other = gas_.geometry.BallOf(local, opposite);
  if (other == GasGeometry::kNoBall) return;
  const uint32_t other_number = replica.first_ball + static_cast<uint32_t>(other);
  if (other_number != number) OrderVisitor(replica, other_number, opposite);
}

}  // namespace ballpiston
