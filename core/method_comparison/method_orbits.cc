#include "core/method_comparison/method_orbits.h"

#include "core/billiard/precise_flow.h"
#include "core/method_comparison/fixed_step_flow.h"

namespace ballpiston {
namespace {

constexpr uint64_t kEventsBetweenLooks = 4096;  // at `stop`: at most 20 ms, in 113 bits

// One orbit of a flow in whatever precision, one event a call of Advance.
template <typename Real>
class EventOrbit {
 public:
  EventOrbit(const PairGeometry& geometry, const PairState& start)
      : flow_(geometry, RoundedTo<Real>(start)) {}

  // True if the contact is reached.
  bool Advance(Contact& contact) {
    const EventOf<Real> event = flow_.Step();
    contact.Add({event.kind, static_cast<double>(event.duration)});
    standing_ = event.duration > 0 ? 0 : standing_ + 1;
    contact.escaped = contact.escaped || standing_ > kStandsStill;
    return contact.escaped || event.kind == EventKind::kBallPiston;
  }
  PairState state() const { return RoundedTo<double>(flow_.state()); }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

 private:
  static constexpr int kStandsStill = 1000;  // events without time between them

  EventFlow<Real> flow_;
  int standing_ = 0;
};

class FixedStepOrbit {
 public:
  FixedStepOrbit(const PairGeometry& geometry, const PairState& start, double time_step)
      : flow_(geometry, start, time_step), time_step_(time_step) {}

  bool Advance(Contact& contact) {
    constexpr uint64_t kMostSteps = 1024;
    const FixedSteps done = flow_.Advance(kMostSteps);
    steps_ += done.steps;
    contact.time = static_cast<double>(steps_) * time_step_;
    contact.ball_wall_hits += done.ball_wall;
    contact.piston_wall_hits += done.piston_wall;
    contact.escaped = done.lost;
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
bool RunOrbit(Orbit orbit, uint64_t index, OrbitSource& source, const std::stop_token& stop) {
  Contact contact;
  for (uint64_t events = 1;; ++events) {
    if (orbit.Advance(contact)) {
      contact.state = orbit.state();
      if (source.Meet(index, contact) == AfterContact::kEnd) return true;
      orbit.ExchangeComponents();
      contact = {};
    }
    if (events % kEventsBetweenLooks == 0 && stop.stop_requested()) return false;
  }
}

template <typename Real>
bool RunEventOrbits(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
                    const std::stop_token& stop) {
  for (uint64_t i = 0; i < orbits; ++i) {
    if (!RunOrbit(EventOrbit<Real>(geometry, source.Start(i)), i, source, stop)) return false;
  }
  return true;
}

bool RunFixedStepOrbits(double time_step, const PairGeometry& geometry, uint64_t orbits,
                        OrbitSource& source, const std::stop_token& stop) {
  for (uint64_t i = 0; i < orbits; ++i) {
    if (!RunOrbit(FixedStepOrbit(geometry, source.Start(i), time_step), i, source, stop)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     OrbitSource& source, const std::stop_token& stop) {
  switch (variant.method) {
    case Method::kFixedStep:
      return RunFixedStepOrbits(variant.time_step, geometry, orbits, source, stop);
    case Method::kReferenceSingle:
      return RunEventOrbits<float>(geometry, orbits, source, stop);
    case Method::kReference:
      return RunOrbits(Engine::kReference, geometry, orbits, source, stop);
    case Method::kReferenceLongDouble:
      return RunEventOrbits<long double>(geometry, orbits, source, stop);
    case Method::kReferenceQuadruple:
      return RunEventOrbits<Quadruple>(geometry, orbits, source, stop);
    case Method::kLanes:
      return RunOrbits(Engine::kLanes, geometry, orbits, source, stop);
    case Method::kLanesSingle:
      return RunOrbits(Engine::kLanesSingle, geometry, orbits, source, stop);
    case Method::kClosedForm:
    case Method::kMarkov:
    case Method::kSpectrum:
      break;
  }
  return true;
}

}  // namespace ballpiston
