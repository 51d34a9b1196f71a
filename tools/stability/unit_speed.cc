#include "tools/stability/unit_speed.h"

#include <algorithm>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"
#include "tools/stability/textbook_flow.h"
#include "tools/stability/wall_starts.h"

namespace ballpiston::stability {
namespace {

uint64_t HitsBefore(const PairGeometry& geometry, const PairState& start) {
  constexpr double kGone = 1e-3;  // depth inside a disc, in cells; far above rounding errors
  TextbookFlow<TextbookRule::kUnitSpeed> flow(geometry, start);
  for (uint64_t hits = 0;; ++hits) {
    if (flow.Step().kind == EventKind::kEscape) return hits;
    if (!InsideCell(geometry, flow.state().position, kGone)) return hits;
  }
}

}  // namespace

std::vector<uint64_t> HitsBeforeEscape(uint64_t orbits) {
  constexpr uint64_t kUnitSpeedSeed = 24;
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  std::vector<uint64_t> hits;
  for (uint64_t i = 0; i < orbits; ++i) {
    CounterRandom random(kUnitSpeedSeed, 0, i);
    hits.push_back(HitsBefore(geometry, AnywhereOnWall(geometry, random)));
  }
  std::sort(hits.begin(), hits.end());
  return hits;
}

}  // namespace ballpiston::stability
