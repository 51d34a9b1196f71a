// Orbits of many pairs by any method, from collision to collision (see billiard/orbits.h). An orbit
// that is lost, or whose time no longer advances, ends with an escape.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <type_traits>

#include "core/billiard/event_flow.h"
#include "core/billiard/orbits.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

// One orbit of a flow in any precision, or with fixed time steps.
template <typename Flow>
class FlowOrbit {
 public:
  template <typename... TimeStep>
  FlowOrbit(const PairGeometry& geometry, const PairStateOf<RealOf<Flow>>& start,
            TimeStep... time_step)
      : flow_(geometry, start, time_step...) {}

  // Makes one event, and adds it to `collision`. True if the orbit reached a collision or is lost.
  bool Advance(Collision& collision) {
    const auto event = flow_.Step();
    collision.Add({event.kind, static_cast<double>(event.duration)});
    standing_ = event.duration > 0 ? 0 : standing_ + 1;
    collision.escaped = collision.escaped || standing_ > kStandsStill;
    return collision.escaped || event.kind == EventKind::kBallPiston;
  }
  PairState state() const { return RoundedTo<double>(flow_.state()); }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

 private:
  static constexpr int kStandsStill = 1000;  // successive events at the same time

  Flow flow_;
  int standing_ = 0;
};

// Calls use(std::type_identity<Flow>(), time step, if any) with the flow of a method of single
// orbits: fixed steps, or the reference in any precision. Aborts for all other methods.
template <typename Use>
auto WithFlowOf(const MethodVariant& variant, const Use& use) {
  switch (variant.method) {
    case Method::kFixedStep:
      return use(std::type_identity<FixedStepFlow>(), variant.time_step);
    case Method::kReferenceSingle:
      return use(std::type_identity<EventFlow<float>>());
    case Method::kReferenceLongDouble:
      return use(std::type_identity<EventFlow<long double>>());
    case Method::kReferenceQuadruple:
      return use(std::type_identity<EventFlow<Quad>>());
    case Method::kReference:
      return use(std::type_identity<ReferenceFlow>());
    case Method::kLanes:
    case Method::kLanesSingle:
    case Method::kClosedForm:
    case Method::kMarkov:
    case Method::kSpectrum:
      break;
  }
  std::abort();
}

// Not for kClosedForm, kMarkov and kSpectrum, which have no such orbits. Starts and collisions are
// doubles; between them all numbers have the method's precision.
void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source);

}  // namespace ballpiston::method_comparison
