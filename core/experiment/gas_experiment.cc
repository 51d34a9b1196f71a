#include "core/experiment/gas_experiment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/arithmetic/elementary_functions.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_shape.h"
#include "core/gas/hit_rates.h"

namespace ballpiston {
namespace {

// The lanes need this many balls to be full.
constexpr int64_t kBallsInLanes = 192;

uint64_t ReplicasThatFillLanes(int64_t balls) {
  return static_cast<uint64_t>((kBallsInLanes + balls - 1) / balls);
}

// Hits of the outermost pistons at their thermal walls per unit of time at temperature 1: every
// second of their wall hits.
double ThermalHitsOf(const GasGeometry& geometry, const HitRates& rates) {
  if (geometry.ends() == GasEnds::kPeriodic) return 0;
  return static_cast<double>(geometry.shape().rows) * rates.of_a_piston;
}

}  // namespace

GasGeometry GasGeometryOf(const PointParameters& point, GasEnds ends) {
  return GasGeometry::Create(point[kRho], point[kDelta], ShapeOf(point[kCells]), ends).value();
}

void CheckGasGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckDeltas(spec.grid, ValidateGasDelta, found);
  if (spec.precision == Precision::kSingle) {
    found.push_back({"precision", "is single; permitted for a gas: double"});
  } else {
    CheckBilliardDomain(spec, found);
  }
}

uint64_t TogetherInLanes(int64_t balls, const ChunkPlan& plan, uint64_t chunk) {
  return std::clamp<uint64_t>(plan.SamplesIn(chunk) / 4, 1, ReplicasThatFillLanes(balls));
}

// Factors measured with chains of 1 to 10^4 cells and lattices to 1000x1000, at deltas from 0.0125
// to 0.2. In lanes a wall hit costs as much as 2.6 of the pair's. An exchange, after which two
// balls fly again, costs as much as a collision of the pair and 345 wall hits, and 360 more shared
// by the replicas that run together, whose balls fly together. A hit of a thermal wall, after which
// one ball flies again, costs 110 wall hits. An event of the reference costs as much as 2.6 of the
// pair's events with 16 bodies in the queue, and 6.6 with 20,000. An exchange of the jump process
// costs as much as 2.1 of the pair's jumps, which are measured with their correlations.
//
// Each visit of a ball to a piston's reach costs 6 wall hits, and there are about stroke/delta
// visits for an exchange. In a gas beyond the processor's caches an exchange costs up to 2300 more.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time) {
  const auto balls = static_cast<double>(geometry.balls());
  const auto pistons = static_cast<double>(geometry.pistons());
  const double exchanges =
      static_cast<double>(geometry.contacts()) * InfiniteGasExchangeRate(geometry, 1) * time;
  if (model == Model::kMarkov) return {.starts = balls, .jumps = 2.1 * exchanges, .together = 1};
  const HitRates rates = HitRatesOf(geometry.pair());
  const double ball_hits = rates.of_a_ball * balls * time;
  if (model == Model::kBilliardReference) {
    const double event = 1 + 1.3 * std::log10(balls + pistons);
    return {.ball_wall = event * ball_hits,
            .piston_wall = event * rates.of_a_piston * pistons * time,
            .collisions = event * exchanges,
            .starts = balls,
            .together = 1};
  }
  const double thermal_hits = ThermalHitsOf(geometry, rates) * time;
  constexpr double kBeyondTheCaches = 7e5;  // balls
  const double uncached = balls / (balls + kBeyondTheCaches);
  const double visits = geometry.pair().stroke() / geometry.pair().delta();
  SampleWork work = {.ball_wall = 2.6 * ball_hits + 345 * exchanges + 110 * thermal_hits,
                     .collisions = exchanges,
                     .starts = balls};
  const ChunkPlan plan(kMaxSamples, Engine::kLanes, work.Events());
  work.together = static_cast<double>(TogetherInLanes(geometry.balls(), plan, 0));
  work.delays = exchanges * (360 / work.together + 6 * visits + 2300 * uncached);
  return work;
}

// Measured with gases of 10^6 cells, chains and lattices: by the lanes 349 bytes for a ball and 64
// for a piston, by the reference 250 and 104, by the jump process 77 and 54. Lists that grow may be
// half empty, so the bound is twice that. The rest is for the blocks in progress.
double MemoryOfReplicas(Model model, const PointParameters& point) {
  constexpr double kBlocksInProgress = 10e6;
  constexpr double kLanes[] = {698, 128}, kReference[] = {500, 208}, kJumps[] = {154, 108};
  const bool in_lanes = model != Model::kMarkov && model != Model::kBilliardReference;
  const double* const bytes = in_lanes ? kLanes : model == Model::kMarkov ? kJumps : kReference;
  const GasShape shape = ShapeOf(point[kCells]);
  // A piston for every contact along +x and +y, and one more in each row between reservoirs.
  const auto balls = static_cast<double>(shape.cells());
  const double pistons = static_cast<double>(shape.contacts() / 2 + shape.rows);
  const double together = in_lanes ? static_cast<double>(ReplicasThatFillLanes(shape.cells())) : 1;
  return kBlocksInProgress + together * (balls * bytes[0] + pistons * bytes[1]);
}

GasExperiment::GasExperiment(const EnsembleSpec& spec, const PointParameters& point,
                             const GasGeometry& geometry, double temperature)
    : PointExperiment(spec, point),
      geometry_(geometry),
      exchange_rate_(WithoutLastBits(GasExchangeRate(geometry, 1))),
      temperature_(temperature) {}

GasEngine GasExperiment::gas_engine() const {
  if (answer().model == Model::kMarkov) return GasEngine::kJumps;
  return engine() == Engine::kReference ? GasEngine::kReference : GasEngine::kLanes;
}

}  // namespace ballpiston
