#include "tools/method_comparison/method_orbits.h"

#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"

namespace ballpiston::method_comparison {
namespace {

// One orbit of a flow in any precision. Each call of Advance makes one event.
template <typename Real>
class EventOrbit {
 public:
  EventOrbit(const PairGeometry& geometry, const PairState& start)
      : flow_(geometry, RoundedTo<Real>(start)) {}

  // True if the collision is reached.
  bool Advance(Collision& collision) {
    const EventOf<Real> event = flow_.Step();
    collision.Add({event.kind, static_cast<double>(event.duration)});
    standing_ = event.duration > 0 ? 0 : standing_ + 1;
    collision.escaped = collision.escaped || standing_ > kStandsStill;
    return collision.escaped || event.kind == EventKind::kBallPiston;
  }
  PairState state() const { return RoundedTo<double>(flow_.state()); }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

 private:
  static constexpr int kStandsStill = 1000;  // successive events at the same time

  EventFlow<Real> flow_;
  int standing_ = 0;
};

class FixedStepOrbit {
 public:
  FixedStepOrbit(const PairGeometry& geometry, const PairState& start, double time_step)
      : flow_(geometry, start, time_step), time_step_(time_step) {}

  bool Advance(Collision& collision) {
    constexpr uint64_t kMostSteps = 1024;
    const FixedSteps done = flow_.Advance(kMostSteps);
    steps_ += done.steps;
    collision.time = static_cast<double>(steps_) * time_step_;
    collision.ball_wall_hits += done.ball_wall;
    collision.piston_wall_hits += done.piston_wall;
    collision.escaped = done.lost;
    return done.lost || done.ball_piston;
  }
  PairState state() const { return flow_.state(); }
  void ExchangeComponents() {
    flow_.ExchangeComponents();
    steps_ = 0;
  }

 private:
  FixedStepFlow flow_;
  double time_step_;
  uint64_t steps_ = 0;
};

template <typename Orbit>
void RunOrbit(Orbit orbit, uint64_t index, NumberedOrbits& source) {
  for (Collision collision;;) {
    if (!orbit.Advance(collision)) continue;
    collision.state = orbit.state();
    if (source.Collide(index, collision) == AfterCollision::kEnd) return;
    orbit.ExchangeComponents();
    collision = {};
  }
}

template <typename Real>
void RunEventOrbits(const PairGeometry& geometry, uint64_t orbits, NumberedOrbits& source) {
  for (uint64_t i = 0; i < orbits; ++i) {
    RunOrbit(EventOrbit<Real>(geometry, source.Start(i)), i, source);
  }
}

void RunEngineOrbits(Engine engine, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source) {
  RunOrbits(engine, geometry, orbits, source);
}

void RunFixedStepOrbits(double time_step, const PairGeometry& geometry, uint64_t orbits,
                        NumberedOrbits& source) {
  for (uint64_t i = 0; i < orbits; ++i) {
    RunOrbit(FixedStepOrbit(geometry, source.Start(i), time_step), i, source);
  }
}

}  // namespace

void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source) {
  switch (variant.method) {
    case Method::kFixedStep:
      return RunFixedStepOrbits(variant.time_step, geometry, orbits, source);
    case Method::kReferenceSingle:
      return RunEventOrbits<float>(geometry, orbits, source);
    case Method::kReference:
      return RunEngineOrbits(Engine::kReference, geometry, orbits, source);
    case Method::kReferenceLongDouble:
      return RunEventOrbits<long double>(geometry, orbits, source);
    case Method::kReferenceQuadruple:
      return RunEventOrbits<Quadruple>(geometry, orbits, source);
    case Method::kLanes:
      return RunEngineOrbits(Engine::kLanes, geometry, orbits, source);
    case Method::kLanesSingle:
      return RunEngineOrbits(Engine::kLanesSingle, geometry, orbits, source);
    case Method::kClosedForm:
    case Method::kMarkov:
    case Method::kSpectrum:
      break;
  }
}

}  // namespace ballpiston::method_comparison
