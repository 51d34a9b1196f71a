// What a closed form costs: the first row of the model ladder.
#include <benchmark/benchmark.h>

#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"

namespace ballpiston {
namespace {

void MeanFreeTimesOfAGeometry(benchmark::State& state) {
  double delta = 0.1;
  for (auto _ : state) {
    const PairGeometry geometry = PairGeometry::Create(kPaperRho, delta).value();
    benchmark::DoNotOptimize(MeanFreeTimesOf(geometry));
    delta = delta > 0.3 ? 0.1 : delta + 1e-9;
  }
}
BENCHMARK(MeanFreeTimesOfAGeometry);

void MomentsOfTheKernel(benchmark::State& state) {
  double ep = 0.1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(PairCollisionRate(ep));
    benchmark::DoNotOptimize(PairEnergyCurrent(ep));
    benchmark::DoNotOptimize(PairSquaredEnergyTransfer(ep));
    ep = ep > 0.4 ? 0.1 : ep + 1e-9;
  }
}
BENCHMARK(MomentsOfTheKernel);

}  // namespace
}  // namespace ballpiston
