#include "tools/method_comparison/method_orbits.h"

#include "tools/flows/precise_flow.h"

namespace ballpiston::method_comparison {
namespace {

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
    RunOrbit(EventOrbit<Real>(geometry, RoundedTo<Real>(source.Start(i))), i, source);
  }
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
    case Method::kReferenceLongDouble:
      return RunEventOrbits<long double>(geometry, orbits, source);
    case Method::kReferenceQuadruple:
      return RunEventOrbits<Quadruple>(geometry, orbits, source);
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
