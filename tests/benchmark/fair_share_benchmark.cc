// The cost of choosing the next run, which the scheduler does under its lock for each turn of
// 0.05 s: with many runs, with many principals, and with runs that have no block to compute.
#include <string>

#include "benchmark/benchmark.h"
#include "server/compute/fair_share.h"

namespace ballpiston::server {
namespace {

constexpr double kBlockSeconds = 0.1;

FairShare RunsOf(int64_t runs, int64_t principals) {
  FairShare share;
  for (int64_t run = 0; run < runs; ++run) {
    share.Add(run, "principal " + std::to_string(run % principals), 0);
  }
  return share;
}

void ChooseBeginEnd(benchmark::State& state) {
  FairShare share = RunsOf(state.range(0), state.range(1));
  for (auto _ : state) {
    const auto run = share.First([](int64_t) { return true; });
    share.TurnBegins(*run);
    share.TurnEnds(*run, kBlockSeconds);
  }
}
BENCHMARK(ChooseBeginEnd)
    ->ArgNames({"runs", "principals"})
    ->Args({1, 1})
    ->Args({100, 1})
    ->Args({10'000, 1})
    ->Args({10'000, 100})
    ->Args({10'000, 10'000});

// So many runs, older than the others, wait for their blocks in flight.
void PassOverThoseWithoutATask(benchmark::State& state) {
  FairShare share = RunsOf(10'000, 10);
  const int64_t waiting = state.range(0);
  for (auto _ : state) {
    const auto run = share.First([waiting](int64_t asked) { return asked >= waiting; });
    share.TurnBegins(*run);
    share.TurnEnds(*run, kBlockSeconds);
  }
}
BENCHMARK(PassOverThoseWithoutATask)->ArgName("waiting")->Arg(2)->Arg(64)->Arg(1024);

void AddAndRemove(benchmark::State& state) {
  FairShare share = RunsOf(state.range(0), 10);
  int64_t run = state.range(0);
  for (auto _ : state) {
    share.Add(++run, "principal 3", 0);
    share.Remove(run);
  }
}
BENCHMARK(AddAndRemove)->ArgName("runs")->Arg(10'000);

}  // namespace
}  // namespace ballpiston::server
