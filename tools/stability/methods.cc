#include "core/billiard/event_flow.h"
#include "core/gas/reference_gas.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/fixed_step_gas.h"
#include "tools/flows/precise_flow.h"
#include "tools/stability/cases.h"
#include "tools/stability/gas_runs.h"
#include "tools/stability/pair_runs.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {

std::vector<PairMethod> BallMethods() {
  using enum TextbookRule;
  return {
      {"lanes", 1, true, FlyInLanes<FlyLaneBalls, double>},
      {"lanes, single", 0.1, false, FlyInLanes<FlyLaneBallsSingle, float>},
      {"reference", 1, true, FlyByEvents<ReferenceFlow>},
      {"reference, single", 0.02, false, FlyByEvents<EventFlow<float>>},
      {"reference, 64 bits", 0.02, true, FlyByEvents<EventFlow<long double>>},
      {"reference, 113 bits", 2e-4, true, FlyByEvents<EventFlow<Quadruple>>},
      {"nearest root", 0.01, false, FlyByEvents<TextbookFlow<kPositiveRoot>>},
      {"nearest root, no threshold", 0.01, false, FlyByEvents<TextbookFlow<kAnyRoot>>},
      {"approaching disc", 0.01, false, FlyByEvents<TextbookFlow<kApproaching>>},
      {"unit speed assumed", 0.01, false, FlyByEvents<TextbookFlow<kUnitSpeed>>},
      {"fixed steps of 1e-3", 1e-3, false, FlyByEvents<FixedStepFlow>},
  };
}

std::vector<PairMethod> PairMethods() {
  using enum TextbookRule;
  // At smaller delta the positions of methods without promise are too inexact for the checks.
  const auto large = [](const PairGeometry& geometry) { return geometry.delta() >= 1e-3; };
  return {
      {"lanes", 1, true, RunByEngine<Engine::kLanes, double>},
      {"lanes, single", 0.1, false, RunByEngine<Engine::kLanesSingle, float>, large},
      {"reference", 1, true, RunByEvents<ReferenceFlow>},
      {"reference, single", 0.02, false, RunByEvents<EventFlow<float>>, large},
      {"reference, 64 bits", 0.02, true, RunByEvents<EventFlow<long double>>},
      {"reference, 113 bits", 1e-3, true, RunByEvents<EventFlow<Quadruple>>},
      {"nearest root", 0.02, false, RunByEvents<TextbookFlow<kPositiveRoot>>, large},
      {"nearest root, no threshold", 0.02, false, RunByEvents<TextbookFlow<kAnyRoot>>, large},
      {"approaching disc", 0.02, false, RunByEvents<TextbookFlow<kApproaching>>, large},
      {"fixed steps of 1e-3", 2e-4, false, RunByEvents<FixedStepFlow>, large},
  };
}

std::vector<GasMethod> GasMethods() {
  return {
      {"lanes", 1, true, RunLaneGases},
      {"reference", 1, true, RunGasesByEvents<ReferenceGas>},
      {"jump process", 1, true, RunJumpGases},
      {"fixed steps of 1e-3", 0.01, false, RunGasesByEvents<FixedStepGas>},
  };
}

}  // namespace ballpiston::stability
