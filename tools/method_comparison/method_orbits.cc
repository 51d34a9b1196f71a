#include "tools/method_comparison/method_orbits.h"

#include <optional>

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

std::optional<Engine> EngineOf(Method method) {
  if (method == Method::kReference) return Engine::kReference;
  if (method == Method::kLanes) return Engine::kLanes;
  if (method == Method::kLanesSingle) return Engine::kLanesSingle;
  return std::nullopt;
}

}  // namespace

void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source) {
  if (const std::optional<Engine> engine = EngineOf(variant.method)) {
    RunOrbits(*engine, geometry, orbits, source);
    return;
  }
  WithFlowOf(variant, [&]<typename Flow>(std::type_identity<Flow>, auto... time_step) {
    RunFlows<Flow>(geometry, orbits, source, time_step...);
  });
}

}  // namespace ballpiston::method_comparison
