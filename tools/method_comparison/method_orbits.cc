#include "tools/method_comparison/method_orbits.h"

#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/precise_flow.h"

namespace ballpiston::method_comparison {
namespace {

template <typename Flow>
void RunOrbit(FlowOrbit<Flow> orbit, uint64_t index, NumberedOrbits& source) {
  for (Collision collision;;) {
    if (!orbit.Advance(collision)) continue;
    collision.state = orbit.state();
    if (source.Collide(index, collision) == AfterCollision::kEnd) return;
    orbit.ExchangeComponents();
    collision = {};
  }
}

template <typename Flow, typename... TimeStep>
void RunFlows(const PairGeometry& geometry, uint64_t orbits, NumberedOrbits& source,
              TimeStep... time_step) {
  for (uint64_t i = 0; i < orbits; ++i) {
    const auto start = RoundedTo<RealOf<Flow>>(source.Start(i));
    RunOrbit(FlowOrbit<Flow>(geometry, start, time_step...), i, source);
  }
}

}  // namespace

void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source) {
  switch (variant.method) {
    case Method::kFixedStep:
      return RunFlows<FixedStepFlow>(geometry, orbits, source, variant.time_step);
    case Method::kReferenceSingle:
      return RunFlows<EventFlow<float>>(geometry, orbits, source);
    case Method::kReferenceLongDouble:
      return RunFlows<EventFlow<long double>>(geometry, orbits, source);
    case Method::kReferenceQuadruple:
      return RunFlows<EventFlow<Quadruple>>(geometry, orbits, source);
    case Method::kReference:
      RunOrbits(Engine::kReference, geometry, orbits, source);
      return;
    case Method::kLanes:
      RunOrbits(Engine::kLanes, geometry, orbits, source);
      return;
    case Method::kLanesSingle:
      RunOrbits(Engine::kLanesSingle, geometry, orbits, source);
      return;
    case Method::kClosedForm:
    case Method::kMarkov:
    case Method::kSpectrum:
      break;
  }
}

}  // namespace ballpiston::method_comparison
