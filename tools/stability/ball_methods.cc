#include "tools/stability/ball_methods.h"

#include <limits>

#include "core/billiard/reference_flow.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/precise_flow.h"
#include "tools/stability/event_methods.h"
#include "tools/stability/fixed_step_events.h"
#include "tools/stability/lane_methods.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

template <FlyLanes fly, typename Real>
BallMethod InLanes(std::string name, double share, bool promised) {
  return {.name = std::move(name),
          .share = share,
          .promised = promised,
          .naive = false,
          .fly =
              [](const PairGeometry& geometry, std::span<const PairState> starts, uint64_t hits) {
                return FlyInLanesWatched(fly, std::numeric_limits<Real>::epsilon(), geometry,
                                         starts, hits);
              },
          .there_and_back =
              [](const PairGeometry& geometry, std::span<const PairState> starts, uint64_t hits) {
                return ThereAndBackInLanes(fly, geometry, starts, hits);
              }};
}

template <typename Flow>
BallMethod ByEvents(std::string name, double share, bool promised, bool naive) {
  return {.name = std::move(name),
          .share = share,
          .promised = promised,
          .naive = naive,
          .fly = FlyByEvents<Flow>,
          .there_and_back = ThereAndBackByEvents<Flow>};
}

}  // namespace

const std::vector<BallMethod>& BallMethods() {
  static const auto* const methods = new std::vector<BallMethod>{
      InLanes<FlyLaneBalls, double>("lanes", 1, true),
      InLanes<FlyLaneBallsSingle, float>("lanes, single", 0.1, false),
      ByEvents<ReferenceFlow>("reference", 1, true, false),
      ByEvents<EventFlow<float>>("reference, single", 0.02, false, false),
      ByEvents<EventFlow<long double>>("reference, 64 bits", 0.02, true, false),
      ByEvents<EventFlow<Quadruple>>("reference, 113 bits", 2e-4, true, false),
      ByEvents<TextbookFlow<TextbookRule::kPositiveRoot>>("nearest root", 0.01, false, true),
      ByEvents<TextbookFlow<TextbookRule::kAnyRoot>>("nearest root, no threshold", 0.01, false,
                                                     true),
      ByEvents<TextbookFlow<TextbookRule::kApproaching>>("approaching disc", 0.01, false, true),
      ByEvents<TextbookFlow<TextbookRule::kUnitSpeed>>("unit speed assumed", 0.01, false, true),
      ByEvents<FixedStepEvents>("fixed steps of 1e-3", 1e-3, false, true),
  };
  return *methods;
}

}  // namespace ballpiston::stability
