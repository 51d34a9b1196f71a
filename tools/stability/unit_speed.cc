#include "tools/stability/unit_speed.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/paper.h"
#include "tools/stability/pair_starts.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

uint64_t HitsBeforeEscape(const PairGeometry& geometry, const PairState& start) {
  constexpr double kGone = 1e-3;  // depth inside a disc, in cells; far above rounding errors
  TextbookFlow<TextbookRule::kUnitSpeed> flow(geometry, start);
  for (uint64_t hits = 0;; ++hits) {
    if (flow.Step().kind == EventKind::kEscape) return hits;
    if (!InsideCell(geometry, flow.state().position, kGone)) return hits;
  }
}

}  // namespace

std::string UnitSpeedSentence() {
  constexpr uint64_t kUnitSpeedSeed = 24, kOrbits = 40;
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.1);
  std::vector<uint64_t> hits;
  for (uint64_t i = 0; i < kOrbits; ++i) {
    CounterRandom random(kUnitSpeedSeed, 0, i);
    hits.push_back(HitsBeforeEscape(geometry, AnywhereOnWall(geometry, random)));
  }
  std::sort(hits.begin(), hits.end());
  return absl::StrCat("Orbits whose hit times assume unit speed leave the cell after ",
                      hits[kOrbits / 2], " hits (median of ", kOrbits,
                      " starts at the paper's radius; ", hits.front(), " at the earliest, ",
                      hits.back(), " at the latest).");
}

}  // namespace ballpiston::stability
