#include <algorithm>
#include <iterator>

#include "core/sampling/invariant_measure.h"
#include "tools/flows/paper.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/case.h"
#include "tools/stability/starts.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kBallSeed = 20;
constexpr uint64_t kPairSeed = 21;
constexpr uint64_t kGasSeed = 24;
// The number of runs of each case of long runs. The standard error of their mean has 47 degrees of
// freedom; by Student's t there are 2e-4 false trends per method.
constexpr uint64_t kLongRuns = 48;
// The permitted |dE/E|: of a ball or a pair, and of a gas. Each exchange in a gas rounds the
// energies of two bodies. The energy makes a random walk, so the bound of a gas is four ulps times
// the square root of its 150,000 exchanges.
constexpr double kRounding = 1e-14, kWalk = 3.5e-13;

using Numbers = std::vector<double>;
using Shapes = std::vector<const char*>;

// ---- the places ----

template <typename Geometry>
std::vector<Place<Geometry>> Each(const std::vector<Geometry>& geometries, uint64_t starts,
                                  uint64_t length) {
  std::vector<Place<Geometry>> places;
  for (const Geometry& geometry : geometries) places.push_back({geometry, starts, length});
  return places;
}

// Pairs and gases whose delta takes each share of its bound.
std::vector<PairGeometry> PairsAt(const Numbers& rhos, const Numbers& shares) {
  std::vector<PairGeometry> pairs;
  for (const double rho : rhos) {
    for (const double share : shares) {
      pairs.push_back(*PairGeometry::Create(rho, share * PairDeltaBound(rho)));
    }
  }
  return pairs;
}

std::vector<GasGeometry> GasesAt(const Numbers& rhos, const Numbers& shares, const Shapes& shapes,
                                 GasEnds ends = GasEnds::kPeriodic) {
  std::vector<GasGeometry> gases;
  for (const double rho : rhos) {
    for (const double share : shares) {
      for (const char* shape : shapes) {
        const double delta = share * GasDeltaBound(rho);
        gases.push_back(*GasGeometry::Create(rho, delta, *ParseGasShape(shape), ends));
      }
    }
  }
  return gases;
}

std::vector<PairGeometry> PaperPairs(const Numbers& deltas) {
  std::vector<PairGeometry> pairs;
  for (const double delta : deltas) pairs.push_back(*PairGeometry::Create(kPaperRho, delta));
  return pairs;
}

// A ball alone, for which any delta will do. It makes so many hits; 0: until no tip can hold it any
// longer.
std::vector<Place<PairGeometry>> CellsAt(const Numbers& rhos, uint64_t starts, uint64_t hits) {
  std::vector<Place<PairGeometry>> places = Each(PairsAt(rhos, {0.5}), starts, hits);
  for (Place<PairGeometry>& place : places) {
    if (hits == 0) place.length = LongestTipSequence(place.geometry) + 4;
  }
  return places;
}

// ---- the starts ----

auto Drawn(uint64_t seed, DrawStart& draw) {
  return [seed, &draw](const PairGeometry& geometry, uint64_t number) {
    CounterRandom random(seed, 0, number);
    return draw(geometry, random);
  };
}
auto Ball(DrawStart& draw) { return Drawn(kBallSeed, draw); }
auto Pair(DrawStart& draw) { return Drawn(kPairSeed, draw); }

// hot and cold are the temperatures of the thermal walls, if there are any. The energy of the
// fastest body is 1/2.
auto Gas(DrawGasStart& draw, double hot = 1, double cold = 1) {
  return [&draw, hot, cold](const GasGeometry& geometry, uint64_t number) {
    const GasRandom random(kGasSeed, 0, number);
    CounterRandom of_start = random.OfStart();
    return GasStart{draw(geometry, of_start), ThermalWalls(geometry, hot, cold, random), random};
  };
}

}  // namespace

std::vector<PairCase> BallCases() {
  constexpr uint64_t kOrbits = 3'000, kMany = 10'000'000, kLong = 10'000, kOneTip = 0;
  return {
      {"any orbits, cusps: rho - 1/2 = 1e-3, 1e-6, 1e-9, 1e-12",
       CellsAt({0.5 + 1e-3, 0.5 + 1e-6, 0.5 + 1e-9, 0.5 + 1e-12}, kOrbits, kLong),
       Ball(AnywhereOnWall)},
      {"any orbits, rho = 0.5296, 0.6, 0.65", CellsAt({kPaperRho, 0.6, 0.65}, kOrbits, kLong),
       Ball(AnywhereOnWall)},
      {"any orbits, vanishing cells: 1/sqrt 2 - rho = 1e-3, 1e-6, 1e-9",
       CellsAt({kMaxRho - 1e-3, kMaxRho - 1e-6, kMaxRho - 1e-9}, kOrbits, kLong),
       Ball(AnywhereOnWall)},
      {"aimed at tips of cusps: rho - 1/2 = 1e-6, 1e-9, 1e-12",
       {CellsAt({0.5 + 1e-6}, 100'000, kOneTip)[0], CellsAt({0.5 + 1e-9}, 4'000, kOneTip)[0],
        CellsAt({0.5 + 1e-12}, 100, kOneTip)[0]},
       Ball(AimedAtTip)},
      {"aimed at tips, rho = 0.501, 0.5296, 0.6, 0.7, 1/sqrt 2 - 1e-6",
       CellsAt({0.501, kPaperRho, 0.6, 0.7, kMaxRho - 1e-6}, kMany, kOneTip), Ball(AimedAtTip)},
      {"grazing, rho = 0.501, 0.5296, 0.6, 0.65, 0.7",
       CellsAt({0.501, kPaperRho, 0.6, 0.65, 0.7}, kMany, kOneTip), Ball(AimedToGraze)},
      {"long, a ball at rho = 0.5296", CellsAt({kPaperRho}, kLongRuns, 10'000'000),
       Ball(AnywhereOnWall), kRounding},
  };
}

std::vector<PairCase> PairCases() {
  constexpr uint64_t kMany = 100'000;
  const Numbers shares = {1, 0.3};
  const auto usual = PairsAt({0.501, kPaperRho, 0.6, 0.7}, shares);
  const auto slow = PairsAt({kPaperRho, 0.6}, shares);
  auto any = usual;
  std::ranges::copy(PairsAt({0.5 + 1e-6, 0.5 + 1e-9, kMaxRho - 1e-3}, {1}),
                    std::back_inserter(any));
  return {
      {"any orbits, also rho - 1/2 = 1e-6, 1e-9 and 1/sqrt 2 - rho = 1e-3", Each(any, 2'000, 20),
       Pair(DrawFromCollisionMeasure)},
      {"piston's edge: wall and piston at one instant", Each(usual, 500'000, 1),
       Pair(AimedAtPistonsEdge)},
      {"piston as it turns at its wall", Each(usual, kMany, 1), Pair(AimedAtPistonsTurn)},
      {"tip and piston at one instant", Each(usual, kMany, 1), Pair(AimedAtTipAndPiston)},
      {"in the wedge between wall and piston", Each(usual, kMany, 1), Pair(InTheWedge)},
      {"slow ball: ep = 1/2 - 1e-3 ... 1e-17 and 1/2", Each(slow, kMany, 1), Pair(SlowBall)},
      {"slow piston: ep = 1e-3 ... 1e-17 and 0", Each(slow, kMany, 1), Pair(SlowPiston)},
      {"piston at delta = 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8",
       Each(PaperPairs({0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8}), kMany, 1), Pair(AimedAtPiston)},
      {"long, a pair at delta = 0.1", Each(PaperPairs({0.1}), kLongRuns, 150'000),
       Pair(DrawFromCollisionMeasure), kRounding},
  };
}

std::vector<GasCase> GasCases() {
  constexpr double kJustUnder = 1 - 1e-9;
  constexpr uint64_t kShort = 30, kLong = 300, kVeryLong = 300'000;  // flights
  constexpr uint64_t kMany = 10'000;                                 // starts
  const Numbers rhos = {0.501, kPaperRho, 0.6, 0.7}, two_rhos = {kPaperRho, 0.6};
  const Numbers bound = {1, kJustUnder}, shares = {1, 0.3};
  const Shapes small = {"1", "3", "1x1", "2x2"};
  const auto usual = Each(GasesAt(rhos, shares, small), 500, kLong);
  const auto aimed = Each(GasesAt(two_rhos, shares, small), kMany, kShort);
  const auto open =
      Each(GasesAt(two_rhos, shares, {"1", "3", "2x2"}, GasEnds::kReservoirs), 500, kLong);
  return {
      {"any gas, delta at its bound and just under it",
       Each(GasesAt(rhos, bound, {"5", "4x3"}), 100, kLong), Gas(AnyGas)},
      {"rings of one cell: the piston meets its ball from both sides",
       Each(GasesAt(rhos, shares, {"1", "1x1"}), 1000, kLong), Gas(AnyGas)},
      {"small tips: rho - 1/2 = 1e-3, 1e-6, 1e-9, 1e-12",
       Each(GasesAt({0.5 + 1e-3, 0.5 + 1e-6, 0.5 + 1e-9, 0.5 + 1e-12}, {1}, small), 500, kLong),
       Gas(AnyGas)},
      {"vanishing cells: 1/sqrt 2 - rho = 1e-3, 1e-6",
       Each(GasesAt({kMaxRho - 1e-3, kMaxRho - 1e-6}, {1}, small), 500, kLong), Gas(AnyGas)},
      {"one hot ball, all else nearly or wholly at rest", usual, Gas(OneHotBall)},
      {"one hot piston, all else nearly or wholly at rest", usual, Gas(OneHotPiston)},
      {"energies from 1 to 1e-17", usual, Gas(AnyEnergies)},
      {"thermal walls at 1 and 1", open, Gas(AnyGas)},
      {"thermal walls at 1 and 1e-9", open, Gas(AnyGas, 1, 1e-9)},
      {"piston's edge: wall and piston at one instant", aimed, Gas(WithPair<AimedAtPistonsEdge>)},
      {"piston as it turns at its wall", aimed, Gas(WithPair<AimedAtPistonsTurn>)},
      {"tip and piston at one instant", aimed, Gas(WithPair<AimedAtTipAndPiston>)},
      {"in the wedge between wall and piston", aimed, Gas(WithPair<InTheWedge>)},
      {"wall and two pistons that cross at one instant",
       Each(GasesAt({0.501, kPaperRho, 0.6}, bound, {"1x1", "3x2"}), kMany, kShort),
       Gas(AimedAtTwoPistons)},
      {"pistons at 1e-2, 1e-4, 1e-6 of the bound",
       Each(GasesAt({kPaperRho}, {1e-2, 1e-4, 1e-6}, small), kMany, kShort),
       Gas(WithPair<AimedAtPiston>)},
      {"long, 4x3 cells at the bound",
       Each(GasesAt({kPaperRho}, {1}, {"4x3"}), kLongRuns, kVeryLong), Gas(AnyGas), kWalk},
  };
}

}  // namespace ballpiston::stability
