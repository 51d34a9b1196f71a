#include "tools/stability/ball_cases.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/paper.h"
#include "tools/stability/drawn_starts.h"
#include "tools/stability/tip_sequence.h"
#include "tools/stability/wall_starts.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kBallSeed = 20;
constexpr uint64_t kBallBatch = 4096;
constexpr double kFewestWanted = 1e-3;

}  // namespace

const std::vector<BallCase>& BallCases() {
  constexpr uint64_t kOrbits = 3'000, kMany = 10'000'000;
  static const auto* const cases = new std::vector<BallCase>{
      {"any orbits, cusps: rho - 1/2 = 1e-3, 1e-6, 1e-9, 1e-12",
       {{0.5 + 1e-3, kOrbits},
        {0.5 + 1e-6, kOrbits},
        {0.5 + 1e-9, kOrbits},
        {0.5 + 1e-12, kOrbits}},
       AnywhereOnWall,
       10'000},
      {"any orbits, rho = 0.5296, 0.6, 0.65",
       {{kPaperRho, kOrbits}, {0.6, kOrbits}, {0.65, kOrbits}},
       AnywhereOnWall,
       10'000},
      {"any orbits, vanishing cells: 1/sqrt 2 - rho = 1e-3, 1e-6, 1e-9",
       {{kMaxRho - 1e-3, kOrbits}, {kMaxRho - 1e-6, kOrbits}, {kMaxRho - 1e-9, kOrbits}},
       AnywhereOnWall,
       10'000},
      {"aimed at tips of cusps: rho - 1/2 = 1e-6, 1e-9, 1e-12",
       {{0.5 + 1e-6, 100'000}, {0.5 + 1e-9, 4'000}, {0.5 + 1e-12, 100}},
       AimedAtTip,
       0},
      {"aimed at tips, rho = 0.501, 0.5296, 0.6, 0.7, 1/sqrt 2 - 1e-6",
       {{0.501, kMany}, {kPaperRho, kMany}, {0.6, kMany}, {0.7, kMany}, {kMaxRho - 1e-6, kMany}},
       AimedAtTip,
       0},
      {"grazing, rho = 0.501, 0.5296, 0.6, 0.65, 0.7",
       {{0.501, kMany}, {kPaperRho, kMany}, {0.6, kMany}, {0.65, kMany}, {0.7, kMany}},
       AimedToGraze,
       0},
  };
  return *cases;
}

Failures FlyCase(const BallCase& ball_case, const BallMethod& method, double effort) {
  Failures failures;
  for (const auto& [rho, all] : ball_case.radii) {
    const double wanted = static_cast<double>(all) * effort * method.share;
    // At least one start would run, a thousand times too many or more. Methods that promise zeros
    // run it nevertheless.
    if (wanted < kFewestWanted && !method.promised) continue;
    const auto starts = static_cast<uint64_t>(std::ceil(wanted));
    // The ball is alone: any delta will do.
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho));
    const uint64_t hits = ball_case.hits > 0 ? ball_case.hits : LongestTipSequence(geometry) + 4;
    for (uint64_t first = 0; first < starts; first += kBallBatch) {
      failures.Merge(method.fly(geometry,
                                DrawnStarts(*ball_case.start, geometry, kBallSeed, first,
                                            std::min(kBallBatch, starts - first)),
                                hits));
    }
  }
  return failures;
}

}  // namespace ballpiston::stability
