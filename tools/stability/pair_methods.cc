// All methods of balls alone and of ball-piston pairs, and their checked runs.
//
// An engine's balls are checked at their wall hits and its pairs at their collisions, a flow after
// every event.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/billiard/exchange.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/piston_wave.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/case.h"
#include "tools/stability/failures.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

// At least the epsilon of a double: the checks themselves are computed in double.
template <typename Flow>
inline constexpr double kEpsilonOf = std::is_same_v<RealOf<Flow>, float>
                                         ? std::numeric_limits<float>::epsilon()
                                         : std::numeric_limits<double>::epsilon();

// The relative error of a state's energy, 2 E - 1. For float and double it is computed in 64 bits,
// so that only the rounding of the state remains; else in the number's own precision.
template <typename Real>
double SignedEnergyError(const PairStateOf<Real>& s) {
  using Wide = std::conditional_t<std::is_floating_point_v<Real>, long double, Real>;
  const PairStateOf<Wide> w = RoundedTo<Wide>(s);
  const Wide ball = w.ball_speed * w.ball_speed * w.direction.squaredNorm();
  return static_cast<double>(Wide(ball + w.piston_velocity * w.piston_velocity - 1));
}

// The same for a ball alone in the lanes: |u|^2 - 1. h^2 + e^2 is near 1/2. Fused multiply-add
// keeps the rounding error small.
double SignedEnergyError(const LaneFrame& frame) {
  return 2 * std::fma(frame.h, frame.h, std::fma(frame.e, frame.e, -0.5));
}

// ---- a ball alone ----

template <FlyLanes& fly, typename Real>
Failures FlyInLanes(const PairGeometry& geometry, std::span<const PairState> starts,
                    uint64_t hits) {
  std::vector<LaneFrame> frames = OnTheirWalls(starts);
  std::vector<LaneHit> hit(starts.size());
  std::vector<BallWatch> watches(starts.size(),
                                 BallWatch(geometry, std::numeric_limits<Real>::epsilon()));
  std::vector<char> flies(starts.size(), 1);
  std::vector<double> middle(starts.size()), last(starts.size());  // dE/E
  size_t flying = starts.size();
  Failures failures = {.orbits = starts.size()};
  for (uint64_t i = 0; i < hits && flying > 0; ++i) {
    fly(geometry, frames, 1, hit);
    for (size_t k = 0; k < frames.size(); ++k) {
      const LaneFrame& frame = frames[k] = hit[k].frame;
      if (!flies[k]) continue;
      last[k] = SignedEnergyError(frame);
      if (i <= hits / 2) middle[k] = last[k];
      failures.SeeEnergy(last[k]);
      flies[k] =
          watches[k].Hit(PositionInCell(frame), DirectionInCell(frame), hit[k].length, failures);
      flying -= !flies[k];
    }
  }
  for (size_t k = 0; k < frames.size(); ++k) {
    if (flies[k]) failures.gain.Add(last[k] - middle[k]);
  }
  return failures;
}

template <typename Flow>
void FlyBall(const PairGeometry& geometry, const PairState& start, uint64_t hits,
             Failures& failures) {
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  BallWatch watch(geometry, kEpsilonOf<Flow>);
  double middle = 0, last = 0;  // dE/E
  for (uint64_t i = 0; i < hits; ++i) {
    const auto event = flow.Step();
    if (event.kind == EventKind::kEscape) {
      ++failures.escapes;
      return;
    }
    const PairState seen = RoundedTo<double>(flow.state());
    const auto length = static_cast<double>(event.duration);
    if (!watch.Hit(seen.position, seen.direction, length, failures)) return;
    last = SignedEnergyError(flow.state());
    if (i <= hits / 2) middle = last;
    failures.SeeEnergy(last);
  }
  failures.gain.Add(last - middle);
}

// ---- a pair by a flow ----

double Approach(const PairState& state) {
  return state.ball_speed * state.direction.x() - state.piston_velocity;
}

// Checks every event of one orbit.
class PairWatch {
 public:
  PairWatch(const PairGeometry& geometry, double epsilon)
      : ball_(geometry, epsilon),
        epsilon_(epsilon),
        short_(ShortFlight(geometry, epsilon)),
        standstill_(short_, LongestStandstill(geometry)) {}

  // Checks the state after the event, before an exchange. False if the orbit has failed.
  bool See(const PairState& state, EventKind kind, double duration, Failures& failures) {
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
    // In a corner several events happen at the same time. The ball may be beyond the piston until
    // its collision is reported.
    const double beyond = state.position.x() - state.piston;
    const bool missed = duration > short_ && beyond > kPositionUlps * epsilon_ &&
                        beyond > ball_.Slack(state.position, state.direction);
    failures.missed += missed;
    return !stands && !missed;
  }

  // Checks the state after an exchange.
  void SeeExchanged(const PairState& state, Failures& failures) const {
    failures.inward += Approach(state) > kDirectionUlps * epsilon_;
  }

 private:
  BallWatch ball_;
  double epsilon_;
  double short_;
  Standstill standstill_;
};

template <typename Flow>
void RunPair(const PairGeometry& geometry, const PairState& start, uint64_t collisions,
             Failures& failures) {
  // While a ball of speed 3e-9 crosses the cell, the piston passes about 1e9 times.
  constexpr uint64_t kMostEvents = 10'000'000'000;
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  PairWatch watch(geometry, kEpsilonOf<Flow>);
  double middle = 0, last = 0;  // dE/E
  for (uint64_t events = 0, left = collisions; left > 0; ++events) {
    if (events == kMostEvents) {
      ++failures.missed;
      return;
    }
    const auto event = flow.Step();
    const auto duration = static_cast<double>(event.duration);
    if (!watch.See(RoundedTo<double>(flow.state()), event.kind, duration, failures)) return;
    last = SignedEnergyError(flow.state());
    if (left > collisions / 2) middle = last;
    failures.SeeEnergy(last);
    if (event.kind != EventKind::kBallPiston) continue;
    --left;
    flow.ExchangeComponents();
    watch.SeeExchanged(RoundedTo<double>(flow.state()), failures);
  }
  failures.gain.Add(last - middle);
}

// ---- pairs by an engine that reports only collisions ----

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

PairState Turned(PairState state, double angle) {
  const Eigen::Vector2d u = state.direction;
  state.direction = (u + angle * Eigen::Vector2d(-u.y(), u.x())).normalized();
  return state;
}

// Whether all values are above `slack`, by more than they differ.
bool Exceeds(const Eigen::ArrayXd& values, double slack) {
  return values.minCoeff() > slack + (values.maxCoeff() - values.minCoeff());
}

// Checks many orbits. To find a missed collision, the ball is moved from the previous collision
// through the piston. It must not be beyond the piston before the engine's collision, and it must
// be at the piston at the engine's collision. Rounding errors grow with every hit. Therefore only
// flights with few hits are checked, together with two neighbouring flights, one on each side. A
// deviation of all three flights that is larger than their differences is not a rounding error.
class CollisionWatch : public NumberedOrbits {
 public:
  CollisionWatch(const PairGeometry& geometry, double epsilon, std::span<const PairState> starts,
                 uint64_t collisions)
      : geometry_(geometry), ball_(geometry, epsilon), epsilon_(epsilon), collisions_(collisions) {
    const Standstill standstill(ShortFlight(geometry, epsilon), LongestStandstill(geometry));
    for (const PairState& start : starts) orbits_.push_back({start, standstill});
    failures_.orbits = starts.size();
    failures_.missed = starts.size();  // each until it has reached its end
  }

  PairState Start(uint64_t orbit) override { return orbits_[orbit].departure; }

  AfterCollision Collide(uint64_t i, const Collision& collision) override {
    Orbit& orbit = orbits_[i];
    const PairState& state = collision.state;
    failures_.escapes += collision.escaped;
    if (collision.escaped || !ball_.IsInCell(state.position, failures_)) return End();
    ++failures_.hits;
    failures_.negative_times += collision.time < 0;
    failures_.SeeEnergy(EnergyError(state));
    failures_.inward += Approach(state) < -kDirectionUlps * epsilon_;
    LookBack(orbit.departure, collision);
    orbit.departure = AfterExchange(state, 1.0);
    if (orbit.standstill.See(collision.time, failures_)) return End();
    const double error = SignedEnergyError(state);
    if (orbit.collisions <= collisions_ / 2) orbit.middle_error = error;
    if (++orbit.collisions < collisions_) return AfterCollision::kGoOn;
    failures_.gain.Add(error - orbit.middle_error);
    return End();
  }

  const Failures& failures() const { return failures_; }

 private:
  struct Orbit {
    PairState departure;
    Standstill standstill;
    uint64_t collisions = 0;
    double middle_error = 0;  // dE/E in the middle of the run
  };

  void LookBack(const PairState& departure, const Collision& collision) {
    constexpr uint64_t kFewHits = 6;
    if (collision.ball_wall_hits > kFewHits || departure.ball_speed == 0) return;
    ++failures_.looked_back;
    // The checking flight has rounding errors too. For a grazing ball two neighbours are not
    // enough.
    Failures found = AsGhostsTell(departure, collision, 1);
    if (found.Total() > 0) found = AsGhostsTell(departure, collision, 8);
    failures_.Merge(found);
  }

  // Checks with this flight and the given number of neighbours on each side.
  Failures AsGhostsTell(const PairState& departure, const Collision& collision,
                        int neighbours) const {
    Eigen::ArrayXd overlaps(2 * neighbours + 1), gaps(2 * neighbours + 1);
    for (int i = -neighbours; i <= neighbours; ++i) {
      const GhostFlight ghost =
          FlyAsGhost(geometry_, Turned(departure, 1e3 * epsilon_ * i), collision.time);
      overlaps[i + neighbours] = ghost.overlap;
      gaps[i + neighbours] = ghost.gap;
    }
    // The piston's phase has the rounding error of its whole path. The time has the rounding errors
    // of as many sums as there were events: for a slow ball millions, all rounded in the same
    // direction.
    const double way = std::fabs(departure.piston_velocity) * collision.time;
    const auto events = static_cast<double>(collision.ball_wall_hits + collision.piston_wall_hits);
    const double slack = epsilon_ * (1e4 * (1 + way) + events * way);
    return {.missed = Exceeds(overlaps, slack),
            .phantoms = Exceeds(gaps, slack) || Exceeds(-gaps, slack)};
  }

  AfterCollision End() {
    --failures_.missed;
    return AfterCollision::kEnd;
  }

  PairGeometry geometry_;
  BallWatch ball_;
  double epsilon_;
  uint64_t collisions_;
  std::vector<Orbit> orbits_;
  Failures failures_;
};

template <Engine engine, typename Real>
Failures RunByEngine(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  CollisionWatch watch(geometry, std::numeric_limits<Real>::epsilon(), starts, collisions);
  watch.Run(engine, geometry, starts.size());
  return watch.failures();
}

}  // namespace

std::vector<PairMethod> BallMethods() {
  using enum TextbookRule;
  return {
      {"lanes", 1, true, FlyInLanes<FlyLaneBalls, double>},
      {"lanes, single", 0.1, false, FlyInLanes<FlyLaneBallsSingle, float>},
      {"reference", 1, true, OneByOne<FlyBall<ReferenceFlow>>},
      {"reference, single", 0.02, false, OneByOne<FlyBall<EventFlow<float>>>},
      {"reference, 64 bits", 0.02, true, OneByOne<FlyBall<EventFlow<long double>>>},
      {"reference, 113 bits", 2e-4, true, OneByOne<FlyBall<EventFlow<Quad>>>},
      {"nearest root", 0.01, false, OneByOne<FlyBall<TextbookFlow<kPositiveRoot>>>},
      {"nearest root, no threshold", 0.01, false, OneByOne<FlyBall<TextbookFlow<kAnyRoot>>>},
      {"approaching disc", 0.01, false, OneByOne<FlyBall<TextbookFlow<kApproaching>>>},
      {"unit speed assumed", 0.01, false, OneByOne<FlyBall<TextbookFlow<kUnitSpeed>>>},
      {"fixed steps of 1e-3", 1e-3, false, OneByOne<FlyBall<FixedStepFlow>>},
  };
}

std::vector<PairMethod> PairMethods() {
  using enum TextbookRule;
  // At smaller delta the positions of methods without promise are too inexact for the checks.
  const auto large = [](const PairGeometry& geometry) { return geometry.delta() >= 1e-3; };
  return {
      {"lanes", 1, true, RunByEngine<Engine::kLanes, double>},
      {"lanes, single", 0.1, false, RunByEngine<Engine::kLanesSingle, float>, large},
      {"reference", 1, true, OneByOne<RunPair<ReferenceFlow>>},
      {"reference, single", 0.02, false, OneByOne<RunPair<EventFlow<float>>>, large},
      {"reference, 64 bits", 0.02, true, OneByOne<RunPair<EventFlow<long double>>>},
      {"reference, 113 bits", 1e-3, true, OneByOne<RunPair<EventFlow<Quad>>>},
      {"nearest root", 0.02, false, OneByOne<RunPair<TextbookFlow<kPositiveRoot>>>, large},
      {"nearest root, no threshold", 0.02, false, OneByOne<RunPair<TextbookFlow<kAnyRoot>>>, large},
      {"approaching disc", 0.02, false, OneByOne<RunPair<TextbookFlow<kApproaching>>>, large},
      {"fixed steps of 1e-3", 2e-4, false, OneByOne<RunPair<FixedStepFlow>>, large},
  };
}

}  // namespace ballpiston::stability
