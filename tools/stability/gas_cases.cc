#include "tools/stability/gas_cases.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/paper.h"
#include "tools/stability/pair_starts.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kGasSeed = 24;
constexpr uint64_t kGasBatch = 256;

using Shapes = std::vector<const char*>;

// delta takes each share of the gas's bound.
std::vector<GasGeometry> GasesAt(const std::vector<double>& rhos, const std::vector<double>& shares,
                                 const Shapes& shapes, GasEnds ends = GasEnds::kPeriodic) {
  std::vector<GasGeometry> geometries;
  for (const double rho : rhos) {
    for (const double share : shares) {
      for (const char* shape : shapes) {
        geometries.push_back(
            *GasGeometry::Create(rho, share * GasDeltaBound(rho), *ParseGasShape(shape), ends));
      }
    }
  }
  return geometries;
}

GasReplica ReplicaOf(const GasCase& gas_case, const GasGeometry& geometry, uint64_t index) {
  const GasRandom random(kGasSeed, 0, index);
  CounterRandom of_start = random.OfStart();
  return {gas_case.start(geometry, of_start),
          ThermalWalls(geometry, gas_case.hot, gas_case.cold, random), random};
}

Failures RunBatch(const GasCase& gas_case, const GasGeometry& geometry, const GasMethod& method,
                  uint64_t first, uint64_t count) {
  std::vector<GasReplica> replicas;
  for (uint64_t i = first; i < first + count; ++i) {
    replicas.push_back(ReplicaOf(gas_case, geometry, i));
  }
  return method.run(geometry, replicas, gas_case.flights);
}

}  // namespace

const std::vector<GasCase>& GasCases() {
  constexpr double kJustUnder = 1 - 1e-9, kShort = 30, kLong = 300;
  const std::vector<double> rhos = {0.501, kPaperRho, 0.6, 0.7}, bound = {1, kJustUnder};
  const Shapes rings = {"1", "1x1"}, small = {"1", "3", "1x1", "2x2"}, lattices = {"1x1", "3x2"};
  const std::vector<GasGeometry> aimed = GasesAt({kPaperRho, 0.6}, {1, 0.3}, small);
  static const auto* const cases = new std::vector<GasCase>{
      {"any gas, delta at its bound and just under it", GasesAt(rhos, bound, {"5", "4x3"}), AnyGas,
       100, kLong},
      {"rings of one cell: the piston meets its ball from both sides",
       GasesAt(rhos, {1, 0.3}, rings), AnyGas, 1000, kLong},
      {"small tips: rho - 1/2 = 1e-3, 1e-6, 1e-9, 1e-12",
       GasesAt({0.5 + 1e-3, 0.5 + 1e-6, 0.5 + 1e-9, 0.5 + 1e-12}, {1}, small), AnyGas, 500, kLong},
      {"vanishing cells: 1/sqrt 2 - rho = 1e-3, 1e-6",
       GasesAt({kMaxRho - 1e-3, kMaxRho - 1e-6}, {1}, small), AnyGas, 500, kLong},
      {"one hot ball, all else nearly or wholly at rest", GasesAt(rhos, {1, 0.3}, small),
       OneHotBall, 500, kLong},
      {"one hot piston, all else nearly or wholly at rest", GasesAt(rhos, {1, 0.3}, small),
       OneHotPiston, 500, kLong},
      {"energies from 1 to 1e-17", GasesAt(rhos, {1, 0.3}, small), AnyEnergies, 500, kLong},
      {"thermal walls at 1 and 1",
       GasesAt({kPaperRho, 0.6}, {1, 0.3}, {"1", "3", "2x2"}, GasEnds::kReservoirs), AnyGas, 500,
       kLong},
      {"thermal walls at 1 and 1e-9",
       GasesAt({kPaperRho, 0.6}, {1, 0.3}, {"1", "3", "2x2"}, GasEnds::kReservoirs), AnyGas, 500,
       kLong, 1, 1e-9},
      {"piston's edge: wall and piston at one instant", aimed, WithPair<AimedAtPistonsEdge>, 10'000,
       kShort},
      {"piston as it turns at its wall", aimed, WithPair<AimedAtPistonsTurn>, 10'000, kShort},
      {"tip and piston at one instant", aimed, WithPair<AimedAtTipAndPiston>, 10'000, kShort},
      {"in the wedge between wall and piston", aimed, WithPair<InTheWedge>, 10'000, kShort},
      {"wall and two pistons that cross at one instant",
       GasesAt({0.501, kPaperRho, 0.6}, bound, lattices), AimedAtTwoPistons, 10'000, kShort},
      {"pistons at 1e-2, 1e-4, 1e-6 of the bound", GasesAt({kPaperRho}, {1e-2, 1e-4, 1e-6}, small),
       WithPair<AimedAtPiston>, 10'000, kShort},
  };
  return *cases;
}

Failures RunGasCase(const GasCase& gas_case, const GasMethod& method, double effort) {
  Failures failures;
  const auto starts = static_cast<uint64_t>(
      std::ceil(static_cast<double>(gas_case.starts) * effort * method.share));
  for (const GasGeometry& geometry : gas_case.geometries) {
    // After a loop the method's remaining starts at this geometry are left out.
    const uint64_t loops = failures.loops;
    for (uint64_t first = 0; first < starts && failures.loops == loops; first += kGasBatch) {
      failures.Merge(
          RunBatch(gas_case, geometry, method, first, std::min(kGasBatch, starts - first)));
    }
  }
  return failures;
}

}  // namespace ballpiston::stability
