#include "core/gas/free_times.h"
#include "core/gas/trace.h"

namespace ballpiston {
namespace {

double BallEnergy(const PairState& state) { return state.ball_speed * state.ball_speed / 2; }
double PistonEnergy(const PairState& state) {
  return state.piston_velocity * state.piston_velocity / 2;
}

TracedBody BallOf(const PairState& state) {
  return {state.position, state.ball_speed * state.direction, BallEnergy(state)};
}

TracedBody PistonOf(const PairState& state) {
  return {{state.piston, 0}, {state.piston_velocity, 0}, PistonEnergy(state)};
}

class PairTrace : public Trace {
 public:
  PairTrace(const PairGeometry& geometry, const PairState& start) : flow_(geometry, start) {}

  std::vector<TracedBody> Balls() const override { return {BallOf(flow_.state())}; }
  std::vector<TracedBody> Pistons() const override { return {PistonOf(flow_.state())}; }

  std::optional<TraceEvent> Next() override {
    if (has_escaped_) return std::nullopt;
    const double ball_energy = BallEnergy(flow_.state());
    const double piston_energy = PistonEnergy(flow_.state());
    const Event event = flow_.Step();
    if (event.kind == EventKind::kBallPiston) flow_.ExchangeComponents();
    time_ += event.duration;
    has_escaped_ = event.kind == EventKind::kEscape;
    TraceEvent traced;
    traced.kind = event.kind;
    traced.time = time_;
    traced.free_time = free_times_.Hit(static_cast<size_t>(event.kind), time_);
    if (event.kind != EventKind::kPistonWall) traced.ball = {0, ball_energy, BallOf(flow_.state())};
    if (event.kind == EventKind::kBallPiston || event.kind == EventKind::kPistonWall) {
      traced.piston = {0, piston_energy, PistonOf(flow_.state())};
    }
    return traced;
  }

 private:
  ReferenceFlow flow_;
  double time_ = 0;
  bool has_escaped_ = false;
  FreeTimes free_times_{4};  // by kind
};

}  // namespace

std::unique_ptr<Trace> TracePair(const PairGeometry& geometry, const PairState& start) {
  return std::make_unique<PairTrace>(geometry, start);
}

}  // namespace ballpiston
