#include "core/gas/trace.h"

#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "core/gas/reference_gas.h"

namespace ballpiston {
namespace {

// An orbit of the pair, with the same functions as GasOrbit. Its events have no energies.
class PairOrbit {
 public:
  PairOrbit(const PairGeometry& geometry, const PairState& start) : flow_(geometry, start) {}

  int64_t balls() const { return 1; }
  int64_t pistons() const { return 1; }

  std::optional<GasEvent> Step() {
    if (has_escaped_) return std::nullopt;
    const auto [kind, duration] = flow_.Step();
    if (kind == EventKind::kBallPiston) flow_.ExchangeComponents();
    time_ += duration;
    has_escaped_ = kind == EventKind::kEscape;
    const bool has_ball = kind != EventKind::kPistonWall;
    const bool has_piston = kind == EventKind::kPistonWall || kind == EventKind::kBallPiston;
    return GasEvent{
        .kind = kind, .time = time_, .ball = has_ball ? 0 : -1, .piston = has_piston ? 0 : -1};
  }

  TracedBody Ball(int64_t, double) const {
    const PairState& s = flow_.state();
    return {s.position, s.ball_speed * s.direction, s.ball_speed * s.ball_speed / 2};
  }
  TracedBody Piston(int64_t, double) const {
    const PairState& s = flow_.state();
    return {{s.piston, 0}, {s.piston_velocity, 0}, s.piston_velocity * s.piston_velocity / 2};
  }

 private:
  ReferenceFlow flow_;
  double time_ = 0;
  bool has_escaped_ = false;
};

class GasOrbit {
 public:
  GasOrbit(const GasGeometry& geometry, const GasState& start)
      : geometry_(geometry), gas_(geometry, start, ThermalWalls()) {}

  int64_t balls() const { return geometry_.balls(); }
  int64_t pistons() const { return geometry_.pistons(); }

  std::optional<GasEvent> Step() {
    return std::isfinite(gas_.NextTime()) ? std::optional(gas_.Step()) : std::nullopt;
  }

  TracedBody Ball(int64_t i, double time) const {
    const GasBall ball = gas_.BallAt(i, time);
    return {geometry_.CentreOfCell(i) + ball.position, ball.speed * ball.direction, EnergyOf(ball)};
  }
  TracedBody Piston(int64_t i, double time) const {
    const GasPiston piston = gas_.PistonAt(i, time);
    const Eigen::Vector2d along =
        geometry_.IsAlongX(i) ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1);
    return {geometry_.MiddleOfEdge(i) + piston.offset * along, piston.velocity * along,
            EnergyOf(piston)};
  }

 private:
  GasGeometry geometry_;
  ReferenceGas gas_;
};

template <class Orbit>
class TraceOf final : public Trace {
 public:
  explicit TraceOf(Orbit orbit) : orbit_(std::move(orbit)) {
    for (const TracedBody& ball : Balls()) ball_energies_.push_back(ball.energy);
    for (const TracedBody& piston : Pistons()) piston_energies_.push_back(piston.energy);
  }

  std::vector<TracedBody> Balls() const override {
    std::vector<TracedBody> balls;
    for (int64_t i = 0; i < orbit_.balls(); ++i) balls.push_back(orbit_.Ball(i, 0));
    return balls;
  }

  std::vector<TracedBody> Pistons() const override {
    std::vector<TracedBody> pistons;
    for (int64_t i = 0; i < orbit_.pistons(); ++i) pistons.push_back(orbit_.Piston(i, 0));
    return pistons;
  }

  std::optional<TraceEvent> Next() override {
    const std::optional<GasEvent> event = orbit_.Step();
    if (!event) return std::nullopt;
    const double time = event->time;
    const int64_t ball = event->ball, piston = event->piston;
    TraceEvent traced = {.kind = event->kind, .time = time};
    const auto [last, is_first] =
        last_.try_emplace({event->kind, ball, piston, event->direction}, time);
    if (!is_first) traced.free_time = time - std::exchange(last->second, time);
    if (ball >= 0) traced.ball = Change(ball, orbit_.Ball(ball, time), ball_energies_);
    if (piston >= 0) traced.piston = Change(piston, orbit_.Piston(piston, time), piston_energies_);
    return traced;
  }

 private:
  static TracedChange Change(int64_t i, const TracedBody& after, std::vector<double>& energies) {
    return {i, std::exchange(energies[static_cast<size_t>(i)], after.energy), after};
  }

  Orbit orbit_;
  std::vector<double> ball_energies_, piston_energies_;  // now
  // The time of the last event of each kind with the same bodies.
  std::map<std::tuple<EventKind, int64_t, int64_t, Direction>, double> last_;
};

}  // namespace

std::unique_ptr<Trace> TracePair(const PairGeometry& geometry, const PairState& start) {
  return std::make_unique<TraceOf<PairOrbit>>(PairOrbit(geometry, start));
}

std::unique_ptr<Trace> TraceGas(const GasGeometry& geometry, const GasState& start) {
  return std::make_unique<TraceOf<GasOrbit>>(GasOrbit(geometry, start));
}

}  // namespace ballpiston
