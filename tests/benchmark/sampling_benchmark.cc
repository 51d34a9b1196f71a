// What starting a sample costs, to compare with the flight that follows.
#include <benchmark/benchmark.h>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"
#include "core/sampling/collision_surface.h"
#include "core/sampling/invariant_measure.h"
#include "core/sampling/outgoing_law.h"

namespace ballpiston {
namespace {

PairGeometry Paper() { return PairGeometry::Create(kPaperRho, 0.05).value(); }

void UniformNumber(benchmark::State& state) {
  CounterRandom random(1, 2, 3);
  for (auto _ : state) benchmark::DoNotOptimize(random.Uniform());
}
BENCHMARK(UniformNumber);

void StartOfAFirstHit(benchmark::State& state) {
  const PairGeometry geometry = Paper();
  const OutgoingLaw law(0.125, static_cast<double>(state.range(0)));
  uint64_t sample = 0;
  for (auto _ : state) {
    CounterRandom random(1, 2, sample++);
    benchmark::DoNotOptimize(UniformOnCollisionSurface(geometry, random));
    benchmark::DoNotOptimize(law.Draw(random));
  }
}
BENCHMARK(StartOfAFirstHit)->Arg(0)->Arg(1)->Arg(10)->Arg(1000);

void StartOfAnEquilibriumOrbit(benchmark::State& state) {
  const PairGeometry geometry = Paper();
  CounterRandom random(1, 2, 3);
  for (auto _ : state) benchmark::DoNotOptimize(DrawFromCollisionMeasure(geometry, random));
}
BENCHMARK(StartOfAnEquilibriumOrbit);

}  // namespace
}  // namespace ballpiston
