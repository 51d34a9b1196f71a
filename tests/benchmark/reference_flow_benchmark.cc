// Events a second of the reference flow, and cycles an event: the yardstick for later engines.
//
// Clocks differ between machines, so beside the rate stand the cycles: the time of an event over
// that of a dependent integer product (3 cycles on every x86 core of the last ten years), measured
// in the same run.
#include <benchmark/benchmark.h>

#include <ctime>

#include "core/billiard/reference_flow.h"
#include "core/geometry/paper.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// Of processor time: what other programs take meanwhile does not count.
double ProcessSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double SecondsPerCycle() {
  constexpr int64_t kProducts = 100'000'000;
  constexpr double kCyclesPerProduct = 3;
  uint64_t x = 3;
  const double begin = ProcessSeconds();
  for (int64_t i = 0; i < kProducts; ++i) {
    x *= x;
    benchmark::DoNotOptimize(x);
  }
  return (ProcessSeconds() - begin) / (kProducts * kCyclesPerProduct);
}

void ReferenceFlowEvents(benchmark::State& state, double delta) {
  const PairGeometry geometry = PairGeometry::Create(kPaperRho, delta).value();
  CounterRandom random(1, 2, 3);
  ReferenceFlow flow(geometry, DrawFromCollisionMeasure(geometry, random));
  const double begin = ProcessSeconds();
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i) {
      if (flow.Step().kind == EventKind::kBallPiston) flow.ExchangeComponents();
    }
  }
  const double elapsed = ProcessSeconds() - begin;
  const double events = 1000 * static_cast<double>(state.iterations());
  state.counters["events/s"] = benchmark::Counter(events, benchmark::Counter::kIsRate);
  state.counters["cycles/event"] = elapsed / events / SecondsPerCycle();
}
BENCHMARK_CAPTURE(ReferenceFlowEvents, delta_0_05, 0.05)->MinTime(1);
BENCHMARK_CAPTURE(ReferenceFlowEvents, delta_0_0125, 0.0125)->MinTime(1);
BENCHMARK_CAPTURE(ReferenceFlowEvents, delta_0_325, 0.325)->MinTime(1);

}  // namespace
}  // namespace ballpiston
