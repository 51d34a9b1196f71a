#include "core/gas/lane_gas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/billiard/exchange.h"
#include "core/gas/hit_rates.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {
namespace {

// A ball slower than this counts as at rest. It gets this speed, at which it never reaches a wall.
constexpr double kAtRest = 1e-18;

// The fixed cost of a window for each ball, in units of a single ball's flight. Flights after an
// exchange are discarded and computed again, ball by ball. So the total time is least if a ball
// flies ahead the root of (this number times the flights between two of its exchanges).
constexpr double kFlightsOfAWindow = 8;
constexpr double kMostFlightsInAWindow = 64;
constexpr size_t kFlightsTogether = 12;
constexpr uint32_t kBallsAtATime = 32 * kMostBallsAhead;

// The period of the origin's moves, in mean flights. In a period the rounding of times stays far
// below kReachSlack. To move the origin costs less than a hundredth of the flights.
constexpr double kFlightsOfAPeriod = 1024;

// Nanoseconds.
constexpr double kToPutABall = 200;
constexpr double kToPutAPiston = 20;
constexpr double kToFindAnArrival = 50;
constexpr double kToMoveABody = 10;
constexpr double kToHandleAnEvent = 300;  // without the flights
constexpr double kToFly = 10;             // one flight of one of many balls

// A power of two, so that any number of periods is exact.
double PeriodOf(double mean_flight) {
  return std::exp2(std::round(std::log2(kFlightsOfAPeriod * mean_flight)));
}

}  // namespace

LaneGas::LaneGas(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas)
    : gas_(geometry),
      balls_each_(static_cast<uint32_t>(geometry.balls())),
      pistons_each_(static_cast<uint32_t>(geometry.pistons())),
      exchange_rate_(exchange_rate),
      mean_flight_(MeanFlight(geometry.pair())),
      period_(PeriodOf(mean_flight_)),
      starts_(std::move(replicas)) {
  for (GasStart& start : starts_) replicas_.push_back({std::move(start.walls), start.meter});
  const size_t balls = starts_.size() * balls_each_, pistons = starts_.size() * pistons_each_;
  gas_.balls.reserve(balls);
  gas_.pistons.reserve(pistons);
  from_.reserve(balls);
  to_.reserve(balls);
  versions_.reserve(balls + pistons);
}

bool LaneGas::Place(Pauses& pauses) {
  if (starts_.empty()) return true;
  if (!ForEachWithPauses(placed_balls_, starts_.size() * balls_each_, kToPutABall, pauses,
                         [this](size_t i) { PlaceBall(i); }) ||
      !ForEachWithPauses(placed_pistons_, starts_.size() * pistons_each_, kToPutAPiston, pauses,
                         [this](size_t i) { PlacePiston(i); })) {
    return false;
  }
  ChooseWindow();
  starts_.clear();
  return true;
}

void LaneGas::PlaceBall(size_t number) {
  const GasBall& ball = starts_[number / balls_each_].state.balls[number % balls_each_];
  to_.push_back(PlacedBall(gas_, ball.position, ball.direction));
  from_.push_back(to_.back());
  const double speed = std::max(ball.speed, kAtRest);
  gas_.balls.push_back({.speed = speed, .slowness = 1 / speed});
  versions_.push_back(0);
  FindPistons(static_cast<uint32_t>(number));
}

void LaneGas::PlacePiston(size_t number) {
  const GasPiston& piston = starts_[number / pistons_each_].state.pistons[number % pistons_each_];
  const PairState seen = {.piston = 0.5 + piston.offset, .piston_velocity = piston.velocity};
  gas_.pistons.push_back({.speed = std::fabs(piston.velocity), .phase = gas_.wave.Phase(seen)});
  versions_.push_back(0);
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
  const double exchanges = gas_.geometry.directions() * exchange_rate_ * std::sqrt(temperature);
  const double best = std::sqrt(kFlightsOfAWindow * flights / std::max(exchanges, kAtRest));
  window_ = std::min(best, kMostFlightsInAWindow) / std::max(flights, kAtRest);
}

bool LaneGas::AdvanceTo(double time, Pauses& pauses) {
  if (!Place(pauses)) return false;
  for (;;) {
    if (is_in_window_ && !FinishWindow(pauses)) return false;
    if (now_ == period_ && !MoveOrigin(pauses)) return false;
    if (now_ >= time - origin_) return true;
    BeginWindow(time - origin_);
  }
}

// Ends at `end` or before it.
void LaneGas::BeginWindow(double end) {
  end_ = std::min({now_ + window_, end, period_});
  is_in_window_ = true;
  std::swap(from_, to_);
  meetings_.clear();
  flown_balls_ = 0;
  found_arrivals_ = gas_.geometry.ends() == GasEnds::kPeriodic ? gas_.pistons.size() : 0;
}

// First all pistons and balls move to the end of the window. Then its events follow in the order of
// time; after each event some balls fly again.
bool LaneGas::FinishWindow(Pauses& pauses) {
  if (!ForEachWithPauses(found_arrivals_, gas_.pistons.size(), kToFindAnArrival, pauses,
                         [this](size_t i) { FindArrival(static_cast<uint32_t>(i)); })) {
    return false;
  }
  for (;;) {
    if (!FlyOrders(pauses)) return false;
    if (flown_balls_ < gas_.balls.size()) {
      FlyNextBalls();
    } else if (!queue_.empty()) {
      const Entry entry = queue_.top();
      queue_.pop();
      if (entry.version != versions_[entry.body]) continue;
      now_ = entry.time;
      Handle(entry);
      if (pauses.After(kToHandleAnEvent)) return false;
    } else {
      break;
    }
  }
  now_ = end_;
  is_in_window_ = false;
  return true;
}

// At the end of a period, with all its events done.
bool LaneGas::MoveOrigin(Pauses& pauses) {
  if (!ForEachWithPauses(moved_balls_, gas_.balls.size(), kToMoveABody, pauses,
                         [this](size_t i) { MoveOriginOfBall(i); }) ||
      !ForEachWithPauses(moved_pistons_, gas_.pistons.size(), kToMoveABody, pauses,
                         [this](size_t i) { MoveOriginOfPiston(i); })) {
    return false;
  }
  moved_balls_ = moved_pistons_ = 0;
  origin_ += period_;
  now_ = 0;
  return true;
}

void LaneGas::MoveOriginOfBall(size_t number) {
  BallInTime& ball = gas_.balls[number];
  ball.since += to_[number].path * gas_.unit * ball.slowness - period_;
  to_[number].path = 0;
}

// An outermost piston gets a new phase at its thermal wall. Its arrival there must not be lost by
// rounding.
void LaneGas::MoveOriginOfPiston(size_t number) {
  PistonInTime& piston = gas_.pistons[number];
  if (replicas_[number / pistons_each_].walls.Has(static_cast<int64_t>(number % pistons_each_))) {
    piston.since -= period_;
  } else {
    piston = {.since = 0,
              .speed = piston.speed,
              .phase = piston.PhaseAt(period_, Direction::kRight, gas_.wave)};
  }
}

void LaneGas::Handle(const Entry& entry) {
  if (entry.body < gas_.balls.size()) {
    Exchange(entry);
  } else {
    LeaveThermalWall(entry);
  }
}

// ---- flights ----

FlightOrder LaneGas::OrderFor(uint32_t number) const {
  const BallInTime& ball = gas_.balls[number];
  return {.ball = number,
          .until = (end_ - ball.since) * ball.speed / gas_.unit,
          .until_time = end_,
          .from_time = now_};
}

void LaneGas::FlyNextBalls() {
  const size_t end = std::min(flown_balls_ + kBallsAtATime, gas_.balls.size());
  for (; flown_balls_ < end; ++flown_balls_) {
    orders_.push_back(OrderFor(static_cast<uint32_t>(flown_balls_)));
  }
  flights_ = kFlightsTogether;
  orders_are_new_ = true;
}

// Flies these balls again, from their states in from_.
void LaneGas::FlyAgain(std::span<const uint32_t> balls) {
  double flights = 0;
  for (const uint32_t ball : balls) {
    ++versions_[ball];
    orders_.push_back(OrderFor(ball));
    const double left = (orders_.back().until - from_[ball].path) * gas_.unit;
    flights = std::max(flights, std::ceil(left / mean_flight_));
  }
  flights_ = static_cast<size_t>(std::min(flights + 1, double{kMostFlightsAhead}));
  orders_are_new_ = true;
}

// Flies until all balls have arrived.
bool LaneGas::FlyOrders(Pauses& pauses) {
  while (!orders_.empty()) {
    const double work = kToFly * static_cast<double>(flights_ * (orders_.size() + 8));
    size_t kept = 0;
    for (size_t first = 0; first < orders_.size(); first += kMostBallsAhead) {
      const std::span<FlightOrder> orders(&orders_[first],
                                          std::min(kMostBallsAhead, orders_.size() - first));
      Fly(orders, orders_are_new_ ? from_ : to_);
      for (const FlightOrder& order : orders) {
        if (!order.has_arrived) orders_[kept++] = order;
      }
    }
    orders_.resize(kept);
    orders_are_new_ = false;
    if (pauses.After(work)) return false;
  }
  return true;
}

void LaneGas::Fly(std::span<FlightOrder> orders, std::span<const FlyingBall> from) {
  FlyAhead(gas_, flights_, orders, from, to_);
  for (FlightOrder& order : orders) {
    if (to_[order.ball].has_escaped) Stop(order);
    if (!order.has_arrived || !order.first) continue;
    meetings_.push_back(*order.first);
    Push({.time = order.first->time, .body = order.ball, .meeting = meetings_.size() - 1});
  }
}

// A ball that has escaped rests in the middle of its cell, where no piston comes. A contact that
// was found on its way does not count.
void LaneGas::Stop(FlightOrder& order) {
  ReplicaOf(order.ball).meter->CountEscape();
  ++versions_[order.ball];
  BallInTime& ball = gas_.balls[order.ball];
  ball.speed = kAtRest;
  ball.slowness = 1 / kAtRest;
  ball.since = now_;
  from_[order.ball] = to_[order.ball] = PlacedBall(gas_, {0, 0}, {1, 0});
  order.has_arrived = true;
  order.first.reset();
}

// ---- contacts ----

// An outermost piston's next arrival at its thermal wall, until the window's end.
void LaneGas::FindArrival(uint32_t number) {
  const ThermalWalls& walls = replicas_[number / pistons_each_].walls;
  const int64_t local = number % pistons_each_;
  if (!walls.Has(local)) return;
  const PistonInTime& piston = gas_.pistons[number];
  const double wall = walls.IsHot(local) ? 2 * gas_.wave.stroke() : gas_.wave.stroke();
  const double phase = piston.phase < wall ? piston.phase : piston.phase - 2 * gas_.wave.stroke();
  const auto body = static_cast<uint32_t>(gas_.balls.size() + number);
  ++versions_[body];
  Push({.time = piston.since + (wall - phase) / piston.speed, .body = body});
}

void LaneGas::Push(Entry entry) {
  entry.version = versions_[entry.body];
  if (entry.time <= end_) queue_.push(entry);
}

void LaneGas::LeaveThermalWall(const Entry& entry) {
  const auto number = static_cast<uint32_t>(entry.body - gas_.balls.size());
  const int64_t local = number % pistons_each_;
  Replica& replica = replicas_[number / pistons_each_];
  const bool is_hot = replica.walls.IsHot(local);
  PistonInTime& piston = gas_.pistons[number];
  piston = {.since = entry.time,
            .speed = replica.walls.DrawSpeed(local),
            .phase = is_hot ? 0 : gas_.wave.stroke()};
  replica.meter->SetPiston(origin_ + entry.time, local, piston.speed * piston.speed / 2);
  FindArrival(number);
  const uint32_t ball = BallOf(number, is_hot ? Direction::kLeft : Direction::kRight);
  FlyAgain({&ball, 1});
}

// The pair's exchange, in the cell turned until the piston is on the right.
void LaneGas::Exchange(const Entry& entry) {
  const uint32_t number = entry.body;
  BallInTime& ball = gas_.balls[number];
  const MeetingInTime meeting = meetings_[entry.meeting];
  const Direction direction = meeting.direction;
  const uint32_t piston_number = ball.pistons[static_cast<size_t>(direction)];
  PistonInTime& piston = gas_.pistons[piston_number];
  PairState before = {.position = SeenToward(direction, meeting.position),
                      .direction = SeenToward(direction, meeting.velocity),
                      .ball_speed = ball.speed > kAtRest ? ball.speed : 0};
  before.piston = before.position.x();
  before.piston_velocity = meeting.piston_goes_right ? piston.speed : -piston.speed;
  const PairState after = AfterExchange(before, std::sqrt(2 * EnergyOf(before)));

  const double half_turn = SignOf(direction) < 0 ? gas_.wave.stroke() : 0;
  piston = {.since = entry.time,
            .speed = std::fabs(after.piston_velocity),
            .phase = std::fmod(gas_.wave.Phase(after) + half_turn, 2 * gas_.wave.stroke())};
  ball.speed = std::max(after.ball_speed, kAtRest);
  ball.slowness = 1 / ball.speed;
  ball.since = entry.time;
  from_[number] =
      PlacedBall(gas_, SeenFrom(direction, after.position), SeenFrom(direction, after.direction));
  ReplicaOf(number).meter->Exchange({.time = origin_ + entry.time,
                                     .ball = number % balls_each_,
                                     .piston = piston_number % pistons_each_,
                                     .direction = direction,
                                     .ball_energy = after.ball_speed * after.ball_speed / 2,
                                     .piston_energy = piston.speed * piston.speed / 2});
  FindArrival(piston_number);
  const uint32_t other = BallOf(piston_number, Opposite(direction));
  const std::array<uint32_t, 2> balls = {number, other};
  FlyAgain({balls.data(), other == kNone || other == number ? size_t{1} : 2});
}

uint32_t LaneGas::BallOf(uint32_t piston, Direction direction) const {
  const uint32_t replica = piston / pistons_each_;
  const int64_t ball = gas_.geometry.BallOf(piston % pistons_each_, direction);
  return ball == GasGeometry::kNoBall ? kNone : replica * balls_each_ + static_cast<uint32_t>(ball);
}

}  // namespace ballpiston
