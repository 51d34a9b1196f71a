// The engines side by side, in one run: what a wall hit costs, and how many times as many samples a
// second the lanes give as the reference does.
//
//   engine_benchmark [--threads N]
//
// Engines take turns of some 50 ms of processor time; a row shows each one's best turn, so that
// what other programs do meanwhile counts as little as it can. With --threads, how many times as
// much N threads do as one.
#include <hwy/targets.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

// After hwy/targets.h.
#include <hwy/highway.h>

#include "core/billiard/lane_balls.h"
#include "core/billiard/lane_frame.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/geometry/paper.h"
#include "core/sampling/direction.h"
#include "server/processor_time.h"

namespace ballpiston {
namespace {

constexpr double kFastestPeer = 8.7e6;  // wall hits a second and core

void Use(int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().DeInit();
}

// A rate of each contender: the best of some turns, taken in alternation.
template <typename Contenders>
std::vector<double> BestRates(const Contenders& contenders, int turns) {
  std::vector<double> best(contenders.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (size_t i = 0; i < contenders.size(); ++i) {
      best[i] = std::max(best[i], contenders[i].Rate(static_cast<uint64_t>(turn)));
    }
  }
  return best;
}

struct FlightContender {
  int64_t target;
  bool single;

  double Rate(uint64_t seed) const {
    Use(target);
    constexpr uint64_t kHits = 100'000, kBalls = 128;
    CounterRandom random(seed, 0, 0);
    std::vector<LaneFrame> starts;
    while (starts.size() < kBalls) {  // leaving the middle of a disc's arc
      Eigen::Vector2d direction = UniformDirection(random);
      if (direction.x() + direction.y() < 0) direction = -direction;
      const double c = kPaperRho * (direction.y() - direction.x()) * M_SQRT1_2;
      const double s = kPaperRho * (direction.y() + direction.x()) * M_SQRT1_2;
      starts.push_back({(direction.x() + direction.y()) / 2, (direction.x() - direction.y()) / 2, c,
                        s, 1, 1, 1});
    }
    const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.05);
    const double begin = server::ThreadSeconds();
    (single ? FlyLaneBallsSingle : FlyLaneBalls)(geometry, starts, kHits, {});
    return kHits * kBalls / (server::ThreadSeconds() - begin);
  }
};

void ShowFlight(int64_t target) {
  const std::vector<FlightContender> contenders = {{target, false}, {target, true}};
  const std::vector<double> rates = BestRates(contenders, 10);
  for (size_t i = 0; i < 2; ++i) {
    std::printf(
        "%-6s %-7s %8.0f million wall hits/s   %5.2f ns a hit   %5.1f times the fastest peer\n",
        hwy::TargetName(target), i == 0 ? "double" : "single", rates[i] * 1e-6, 1e9 / rates[i],
        rates[i] / kFastestPeer);
  }
}

EnsembleSpec Question(const ExperimentKind* experiment, double delta, Model model,
                      Precision precision) {
  EnsembleSpec spec = {.experiment = experiment,
                       .grid = {{kRho, {kPaperRho}}, {kDelta, {delta}}},
                       .seed = 5,
                       .model = model,
                       .precision = precision};
  if (experiment == &kEquilibrium) {
    spec.target.collisions = 100'000'000;
  } else {
    spec.grid[kEpsilon] = {0.125};
    spec.target.samples = 10'000'000;
  }
  if (experiment == &kFirstHit) spec.grid[kExponent] = {1};
  return spec;
}

// A block takes about 50 ms: it has fewer samples for the reference than for the lanes.
Block BlockOfATurn(const PointExperiment& point, uint64_t turn) {
  const double events = point.answer().model == Model::kBilliardReference ? 0x1p20 : 0x1p24;
  const uint64_t samples =
      std::max(static_cast<uint64_t>(events / point.plan().events_per_sample()), uint64_t{1});
  return {.first = turn * samples, .samples = samples};
}

struct EngineContender {
  int64_t target;
  const PointExperiment* point;
  double exact_time;  // of a sample

  // Samples a second; by the time they flew, not by their number: blocks differ by luck.
  double Rate(uint64_t turn) const {
    Use(target);
    const Block block = BlockOfATurn(*point, turn);
    const double begin = server::ThreadSeconds();
    const BlockResult result = *RunBlock(*point, block);
    const double elapsed = server::ThreadSeconds() - begin;
    const double flown = result.moments.empty()
                             ? *result.batch_means[0].Ratio() * static_cast<double>(result.samples)
                             : result.moments[0].mean * static_cast<double>(result.samples);
    return flown / exact_time / elapsed;
  }
};

double ExactTime(const PointExperiment& point) {
  return *point.FirstEstimate(*RunBlock(point, {.samples = 1})).exact;
}

void ShowEngines(const char* name, const ExperimentKind* experiment, double delta, int64_t target) {
  const auto reference = PointExperiment::Create(
      Question(experiment, delta, Model::kBilliardReference, Precision::kDouble), 0);
  const auto lanes =
      PointExperiment::Create(Question(experiment, delta, Model::kBilliard, Precision::kDouble), 0);
  const auto single =
      PointExperiment::Create(Question(experiment, delta, Model::kBilliard, Precision::kSingle), 0);
  const double time = ExactTime(*reference);
  const std::vector<EngineContender> contenders = {
      {target, reference.get(), time}, {target, lanes.get(), time}, {target, single.get(), time}};
  const std::vector<double> rates = BestRates(contenders, 12);
  std::printf(
      "%-6s %-12s delta %-7g reference %9.0f samples/s (%5.1f million events/s)   "
      "billiard %9.0f: %5.1f times   single: %5.1f times\n",
      hwy::TargetName(target), name, delta, rates[0],
      rates[0] * reference->plan().events_per_sample() * 1e-6, rates[1], rates[1] / rates[0],
      rates[2] / rates[0]);
}

// Blocks a second of `threads` threads that share eight blocks.
double BlocksPerSecond(const PointExperiment& point, unsigned threads) {
  constexpr uint64_t kBlocks = 8;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> running;
  for (unsigned i = 0; i < threads; ++i) {
    running.emplace_back([&point, i, threads] {
      for (uint64_t k = i; k < kBlocks; k += threads) RunBlock(point, BlockOfATurn(point, k));
    });
  }
  for (std::thread& thread : running) thread.join();
  return kBlocks / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void ShowThreads(unsigned threads) {
  const auto point = PointExperiment::Create(
      Question(&kFirstHit, 0.0125, Model::kBilliard, Precision::kDouble), 0);
  double one = 0, all = 0;
  for (int turn = 0; turn < 6; ++turn) {
    one = std::max(one, BlocksPerSecond(*point, 1));
    all = std::max(all, BlocksPerSecond(*point, threads));
  }
  std::printf("first-hit, delta 0.0125: %u threads do %.2f times as much as one\n", threads,
              all / one);
}

void ShowAll() {
  std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  std::reverse(targets.begin(), targets.end());
  for (const int64_t target : targets) {
    if (target <= HWY_SSE4) ShowFlight(target);
  }
  for (const int64_t target : targets) {
    if (target > HWY_SSE4) continue;
    ShowEngines("first-hit", &kFirstHit, 0.0125, target);
    ShowEngines("first-hit", &kFirstHit, 0.05, target);
    ShowEngines("equilibrium", &kEquilibrium, 0.05, target);
    ShowEngines("equilibrium", &kEquilibrium, 0.2, target);
  }
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--threads") == 0) {
    ballpiston::ShowThreads(static_cast<unsigned>(std::max(std::atoi(argv[2]), 1)));
  } else {
    ballpiston::ShowAll();
  }
}
