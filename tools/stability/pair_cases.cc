#include "tools/stability/pair_cases.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/paper.h"
#include "tools/stability/drawn_starts.h"
#include "tools/stability/pair_starts.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kPairSeed = 21;
constexpr uint64_t kPairBatch = 4096;

std::vector<PairGeometry> AtShares(const std::vector<double>& rhos,
                                   const std::vector<double>& shares) {
  std::vector<PairGeometry> geometries;
  for (const double rho : rhos) {
    for (const double share : shares) {
      geometries.push_back(*PairGeometry::Create(rho, share * PairDeltaBound(rho)));
    }
  }
  return geometries;
}

// At the paper's radius.
std::vector<PairGeometry> AtDeltas(const std::vector<double>& deltas) {
  std::vector<PairGeometry> geometries;
  for (const double delta : deltas) geometries.push_back(*PairGeometry::Create(kPaperRho, delta));
  return geometries;
}

std::vector<PairGeometry> Joined(std::vector<PairGeometry> some,
                                 const std::vector<PairGeometry>& others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace

const std::vector<PairCase>& PairCases() {
  const std::vector<double> rhos = {0.501, kPaperRho, 0.6, 0.7}, shares = {1, 0.3};
  const std::vector<PairGeometry> geometries = AtShares(rhos, shares);
  static const auto* const cases = new std::vector<PairCase>{
      {"any orbits, also rho - 1/2 = 1e-6, 1e-9 and 1/sqrt 2 - rho = 1e-3",
       Joined(geometries, AtShares({0.5 + 1e-6, 0.5 + 1e-9, kMaxRho - 1e-3}, {1})), AnyCollision,
       2'000, 20},
      {"piston's edge: wall and piston at one instant", geometries, AimedAtPistonsEdge, 500'000, 1},
      {"piston as it turns at its wall", geometries, AimedAtPistonsTurn, 100'000, 1},
      {"tip and piston at one instant", geometries, AimedAtTipAndPiston, 100'000, 1},
      {"in the wedge between wall and piston", geometries, InTheWedge, 100'000, 1},
      {"slow ball: ep = 1/2 - 1e-3 ... 1e-17 and 1/2", AtShares({kPaperRho, 0.6}, shares), SlowBall,
       100'000, 1},
      {"slow piston: ep = 1e-3 ... 1e-17 and 0", AtShares({kPaperRho, 0.6}, shares), SlowPiston,
       100'000, 1},
      {"piston at delta = 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8",
       AtDeltas({0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8}), AimedAtPiston, 100'000, 1},
  };
  return *cases;
}

Failures RunCase(const PairCase& pair_case, const PairMethod& method, double effort) {
  Failures failures;
  const auto starts = static_cast<uint64_t>(
      std::ceil(static_cast<double>(pair_case.starts) * effort * method.share));
  for (const PairGeometry& geometry : pair_case.geometries) {
    if (geometry.delta() < method.smallest_delta) continue;
    for (uint64_t first = 0; first < starts; first += kPairBatch) {
      failures.Merge(method.run(geometry,
                                DrawnStarts(*pair_case.start, geometry, kPairSeed, first,
                                            std::min(kPairBatch, starts - first)),
                                pair_case.collisions));
    }
  }
  return failures;
}

}  // namespace ballpiston::stability
