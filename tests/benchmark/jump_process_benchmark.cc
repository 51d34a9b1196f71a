// Jumps a second of the pair's jump process: the scalar definition, and the lanes with every
// instruction set, beside the collisions a second of the billiard that the process is the limit
// of. One run measures all of them, so their ratios hold although clocks and neighbours change.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

// After hwy/targets.h.
#include <hwy/highway.h>

#include "core/geometry/paper.h"
#include "core/markov/jump_process.h"
#include "core/sampling/counter_random.h"
#include "core/sampling/invariant_measure.h"
#include "server/processor_time.h"
#include "tests/oracle/scalar_jump.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {
namespace {

constexpr double kDelta = 0.0125;

// The best of the pieces measured so far; 0 before.
double scalar_jumps_per_second = 0;
double billiard_collisions_per_second = 0;

// Runs pieces of some work until the time is over; the best rate counts, as that with the least
// work of other programs in it. `piece` does `count` things.
template <typename Piece>
double BestRate(benchmark::State& state, double count, const Piece& piece) {
  double best = 0;
  for (auto _ : state) {
    const double begin = server::ThreadSeconds();
    piece();
    best = std::max(best, count / (server::ThreadSeconds() - begin));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(count));
  state.counters["best/s"] = best;
  return best;
}

// Starts in equilibrium and ends an orbit after some collisions.
class Equilibrium : public NumberedOrbits {
 public:
  Equilibrium(const PairGeometry& geometry, uint64_t orbits)
      : geometry_(geometry), collisions_(orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(1, 2, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }
  AfterCollision Collide(uint64_t orbit, const Collision&) override {
    return ++collisions_[orbit] == kCollisions ? AfterCollision::kEnd : AfterCollision::kGoOn;
  }

  static constexpr uint64_t kCollisions = 4;

 private:
  PairGeometry geometry_;
  std::vector<uint64_t> collisions_;
};

void Billiard(benchmark::State& state) {
  constexpr uint64_t kOrbits = 1000;
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, kDelta);
  billiard_collisions_per_second = BestRate(state, kOrbits * Equilibrium::kCollisions, [&] {
    Equilibrium source(geometry, kOrbits);
    RunOrbits(Engine::kLanes, geometry, kOrbits, source);
  });
}

void ShowRatios(benchmark::State& state, double rate) {
  if (scalar_jumps_per_second > 0) state.counters["x scalar"] = rate / scalar_jumps_per_second;
  if (billiard_collisions_per_second > 0) {
    state.counters["x billiard"] = rate / billiard_collisions_per_second;
  }
}

void ScalarJumps(benchmark::State& state) {
  constexpr int kJumps = 10'000;
  double u = 0.5;
  CounterRandom random(1, 2, 3);
  scalar_jumps_per_second = BestRate(state, kJumps, [&] {
    for (int n = 0; n < kJumps; ++n) {
      const double waiting = random.Uniform();
      const oracle::Jump jump = oracle::JumpFrom(u, waiting, random.Uniform());
      benchmark::DoNotOptimize(jump.waiting_time);
      u = jump.u;
    }
  });
  ShowRatios(state, scalar_jumps_per_second);
}

void LaneJumps(benchmark::State& state, int64_t target) {
  constexpr size_t kWalkers = 1024;
  constexpr int kJumps = 20;
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().DeInit();
  JumpWalkers walkers(1, 2, 3, std::vector<double>(kWalkers, 0.5));
  ShowRatios(state, BestRate(state, kWalkers * kJumps, [&] {
               for (int n = 0; n < kJumps; ++n) walkers.Jump();
               benchmark::DoNotOptimize(walkers.u().data());
             }));
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

// The parts of a jump in lanes, with what instructions the machine has.
void WordsOfJumps(benchmark::State& state) {
  JumpWords drawn;
  uint64_t block = 0;
  BestRate(state, 2 * kJumpGroup * 100, [&] {
    for (int n = 0; n < 100; ++n) DrawJumpWords(1, 2, 3, block++, drawn);
    benchmark::DoNotOptimize(drawn);
  });
}

void JumpsOfGivenWords(benchmark::State& state) {
  JumpWords drawn;
  DrawJumpWords(1, 2, 3, 4, drawn);
  std::vector<double> u(kJumpGroup, 0.5), times(kJumpGroup);
  BestRate(state, 2 * kJumpGroup * 100, [&] {
    for (int n = 0; n < 100; ++n) {
      for (size_t word = 0; word < 4; word += 2) {
        JumpInLanes(drawn.words[word], drawn.words[word + 1], u.data(), times.data());
      }
    }
    benchmark::DoNotOptimize(times.data());
  });
}

void Register() {
  benchmark::RegisterBenchmark("Billiard, delta 0.0125: collisions", Billiard)->MinTime(2);
  benchmark::RegisterBenchmark("JumpFrom, scalar: jumps", ScalarJumps);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const std::string name = std::string("JumpWalkers, ") + hwy::TargetName(target) + ": jumps";
    benchmark::RegisterBenchmark(name.c_str(), LaneJumps, target);
  }
  benchmark::RegisterBenchmark("of which random words", WordsOfJumps);
  benchmark::RegisterBenchmark("of which the jumps", JumpsOfGivenWords);
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  ballpiston::Register();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
