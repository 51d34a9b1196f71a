#include "tools/stability/pair_watch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/billiard/piston_wave.h"
#include "tools/flows/energy_error.h"

namespace ballpiston::stability {
namespace {

double Approach(const PairState& state) {
  return state.ball_speed * state.direction.x() - state.piston_velocity;
}

PairState Turned(PairState state, double angle) {
  const Eigen::Vector2d u = state.direction;
  state.direction = (u + angle * Eigen::Vector2d(-u.y(), u.x())).normalized();
  return state;
}

// Whether all values are above `slack`, by more than they differ.
bool Exceeds(const std::vector<double>& values, double slack) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *least > slack + (*most - *least);
}

// The piston's motion as a function of time.
class PistonInTime {
 public:
  PistonInTime(const PairGeometry& geometry, const PairState& from)
      : wave_(geometry), phase_(wave_.Phase(from)), speed_(std::fabs(from.piston_velocity)) {}

  double Position(double time) const {
    return wave_.Position(std::fmod(phase_ + speed_ * time, Period()));
  }

  // The time of the piston's first turn at its left wall after `time`; infinity if it rests.
  double NextLeftTurn(double time) const {
    if (speed_ == 0) return HUGE_VAL;
    const double way = phase_ + speed_ * time;
    return (std::floor(way / Period() + 1) * Period() - phase_) / speed_;
  }

 private:
  double Period() const { return 2 * wave_.stroke(); }

  PistonWave wave_;
  double phase_;
  double speed_;
};

// The flight of a ball that passes through the piston. It shows where the two really collide.
struct GhostFlight {
  double overlap;  // the largest distance of the ball to the right of the piston; negative: never
  double gap;      // the distance of the ball to the left of the piston at the end
};

// Moves the ball for this time. The ball must not be at rest.
GhostFlight FlyAsGhost(const PairGeometry& geometry, const PairState& from, double time) {
  const PistonInTime piston(geometry, from);
  ReferenceFlow ball(geometry, {.position = from.position,
                                .direction = from.direction,
                                .ball_speed = 1,
                                .piston = geometry.piston_right(),
                                .piston_velocity = 0});
  // The distance of the ball to the right of the piston is piecewise linear in time. Its peaks are
  // at the ball's wall hits and at the piston's left turns.
  double overlap = -HUGE_VAL, now = 0;
  for (;;) {
    const double x = ball.state().position.x();
    const double v1 = from.ball_speed * ball.state().direction.x();
    const double hit = now + ball.Step().duration / from.ball_speed;
    const double end = std::min(hit, time), turn = piston.NextLeftTurn(now);
    const auto ahead = [&](double t) { return x + v1 * (t - now) - piston.Position(t); };
    if (turn < end) overlap = std::max(overlap, ahead(turn));
    if (hit >= time) return {.overlap = overlap, .gap = -ahead(time)};
    overlap = std::max(overlap, ahead(hit));
    now = hit;
  }
}

}  // namespace

PairWatch::PairWatch(const PairGeometry& geometry, double epsilon)
    : ball_(geometry, epsilon),
      epsilon_(epsilon),
      short_(ShortFlight(geometry, epsilon)),
      standstill_(short_, LongestStandstill(geometry)) {}

bool PairWatch::See(const PairState& state, EventKind kind, double duration, Failures& failures) {
  failures.negative_times += duration < 0;
  if (kind == EventKind::kEscape) {
    ++failures.escapes;
    return false;
  }
  if (!ball_.IsInCell(state.position, failures)) return false;
  if (kind == EventKind::kBallWall)
    failures.inward += ball_.HeadsInward(state.position, state.direction);
  failures.hits += kind == EventKind::kBallPiston;
  failures.looked_back += kind == EventKind::kBallPiston;
  const bool stands = standstill_.See(duration, failures);
  // In a corner several events happen at the same time. The ball may be beyond the piston until its
  // collision is reported.
  const double beyond = state.position.x() - state.piston;
  const bool missed = duration > short_ && beyond > kPositionUlps * epsilon_ &&
                      beyond > ball_.Slack(state.position, state.direction);
  failures.missed += missed;
  return !stands && !missed;
}

void PairWatch::SeeExchanged(const PairState& state, Failures& failures) {
  failures.inward += Approach(state) > kDirectionUlps * epsilon_;
}

CollisionWatch::CollisionWatch(const PairGeometry& geometry, double epsilon,
                               std::span<const PairState> starts, uint64_t collisions)
    : geometry_(geometry), ball_(geometry, epsilon), epsilon_(epsilon), collisions_(collisions) {
  const Standstill standstill(ShortFlight(geometry, epsilon), LongestStandstill(geometry));
  for (const PairState& start : starts) orbits_.push_back({start, standstill});
}

AfterCollision CollisionWatch::Collide(uint64_t i, const Collision& collision) {
  Orbit& orbit = orbits_[i];
  const PairState& state = collision.state;
  failures_.escapes += collision.escaped;
  if (collision.escaped || !ball_.IsInCell(state.position, failures_)) return End(orbit);
  ++failures_.hits;
  failures_.negative_times += collision.time < 0;
  failures_.SeeEnergy(EnergyError(state));
  failures_.inward += Approach(state) < -kDirectionUlps * epsilon_;
  LookBack(orbit.departure, collision);
  ReferenceFlow flow(geometry_, state);
  flow.ExchangeComponents();
  orbit.departure = flow.state();
  if (orbit.standstill.See(collision.time, failures_)) return End(orbit);
  const double error = SignedEnergyError(state);
  if (orbit.collisions <= collisions_ / 2) orbit.middle_error = error;
  if (++orbit.collisions < collisions_) return AfterCollision::kGoOn;
  failures_.gain.Add(error - orbit.middle_error);
  return End(orbit);
}

void CollisionWatch::LookBack(const PairState& departure, const Collision& collision) {
  constexpr uint64_t kFewHits = 6;
  if (collision.ball_wall_hits > kFewHits || departure.ball_speed == 0) return;
  ++failures_.looked_back;
  // The checking flight has rounding errors too. For a grazing ball two neighbours are not enough.
  Failures found = AsGhostsTell(departure, collision, 1);
  if (found.Total() > 0) found = AsGhostsTell(departure, collision, 8);
  failures_.Merge(found);
}

// Checks with this flight and the given number of neighbours on each side.
Failures CollisionWatch::AsGhostsTell(const PairState& departure, const Collision& collision,
                                      int neighbours) const {
  std::vector<double> overlaps, gaps, beyond;
  for (int i = -neighbours; i <= neighbours; ++i) {
    const GhostFlight ghost =
        FlyAsGhost(geometry_, Turned(departure, 1e3 * epsilon_ * i), collision.time);
    overlaps.push_back(ghost.overlap);
    gaps.push_back(ghost.gap);
    beyond.push_back(-ghost.gap);
  }
  // The piston's phase has the rounding error of its whole path. The time has the rounding errors
  // of as many sums as there were events: for a slow ball millions, all rounded in the same
  // direction.
  const double way = std::fabs(departure.piston_velocity) * collision.time;
  const auto events = static_cast<double>(collision.ball_wall_hits + collision.piston_wall_hits);
  const double slack = epsilon_ * (1e4 * (1 + way) + events * way);
  Failures found;
  found.missed += Exceeds(overlaps, slack);
  found.phantoms += Exceeds(gaps, slack) || Exceeds(beyond, slack);
  return found;
}

AfterCollision CollisionWatch::End(Orbit& orbit) {
  orbit.ended = true;
  return AfterCollision::kEnd;
}

Failures CollisionWatch::Finish() {
  failures_.orbits = orbits_.size();
  for (const Orbit& orbit : orbits_) failures_.missed += !orbit.ended;
  return failures_;
}

}  // namespace ballpiston::stability
