// The engines side by side, in one run: what a wall hit costs, and how many times as many samples a
// second the lanes give as the reference does. The closed form and the jump process come first;
// they need no engine.
//
//   engine_benchmark [--threads N]
//
// The yardsticks run in the same run: the reference, and a plain scalar ball as billiard codes have
// it. Contenders take turns of some 50 ms of processor time; a row shows each one's best turn, and
// says if a neighbour disturbed it (turns.h). With --threads, how many times as much N threads do
// as one, and how many times as much of the independent operations of the probe.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/lane_frame.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/markov/jump_process.h"
#include "core/sampling/direction.h"
#include "tests/benchmark/turns.h"
#include "tests/benchmark/vector_targets.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/paper.h"

namespace ballpiston {
namespace {

constexpr uint64_t kHits = 100'000, kBalls = 128;  // as many balls as the widest lanes have

std::vector<LaneFrame> BallsFromTheMiddleOfAnArc(uint64_t seed) {
  CounterRandom random(seed, 0, 0);
  std::vector<LaneFrame> balls;
  while (balls.size() < kBalls) {
    Eigen::Vector2d direction = UniformDirection(random);
    if (direction.x() + direction.y() < 0) direction = -direction;
    const double c = kPaperRho * (direction.y() - direction.x()) * M_SQRT1_2;
    const double s = kPaperRho * (direction.y() + direction.x()) * M_SQRT1_2;
    balls.push_back(
        {(direction.x() + direction.y()) / 2, (direction.x() - direction.y()) / 2, c, s, 1, 1, 1});
  }
  return balls;
}

// Returns the number of hits.
double HitsInLanes(int64_t target, bool single, uint64_t turn) {
  Use(target);
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, 0.05);
  (single ? FlyLaneBallsSingle : FlyLaneBalls)(geometry, BallsFromTheMiddleOfAnArc(turn), kHits,
                                               {});
  return kHits * kBalls;
}

Eigen::Vector2d Centre(int disc) {
  return {(disc & 1) != 0 ? 0.5 : -0.5, (disc & 2) != 0 ? 0.5 : -0.5};
}

// The method of most billiard codes: the nearest of the roots over all discs, then u - 2 (u . n) n;
// then the direction is normalised.
void Fly(Eigen::Vector2d& position, Eigen::Vector2d& direction, int& left) {
  double nearest = std::numeric_limits<double>::infinity();
  int next = left;
  for (int disc = 0; disc < 4; ++disc) {
    if (disc == left) continue;
    const Eigen::Vector2d away = position - Centre(disc);
    const double along = direction.dot(away);
    const double square = along * along - (away.squaredNorm() - kPaperRho * kPaperRho);
    if (along >= 0 || square < 0) continue;
    const double distance = -along - std::sqrt(square);
    if (distance < nearest) {
      nearest = distance;
      next = disc;
    }
  }
  position += direction * std::min(nearest, 1.0);
  const Eigen::Vector2d normal = (position - Centre(next)).normalized();
  direction = (direction - normal * (2 * direction.dot(normal))).normalized();
  left = next;
}

double ScalarHits(uint64_t turn) {
  constexpr uint64_t kScalarHits = 500'000;
  const LaneFrame start = BallsFromTheMiddleOfAnArc(turn)[0];
  Eigen::Vector2d position = PositionInCell(start), direction = DirectionInCell(start);
  int left = -1;  // the disc
  for (uint64_t hit = 0; hit < kScalarHits; ++hit) Fly(position, direction, left);
  Keep(position.x());
  return kScalarHits;
}

void ShowFlight(int64_t target) {
  const auto lanes = [target](const char* precision, bool single) -> Contender {
    return {absl::StrCat("wall hits, ", hwy::TargetName(target), " ", precision),
            [=](uint64_t turn) { return HitsInLanes(target, single, turn); }};
  };
  ShowRates({{"wall hits, scalar", ScalarHits}, lanes("double", false), lanes("single", true)}, 15,
            " times");
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

// The samples of a turn, counted by their flight time, in which blocks of the same size differ.
double SamplesOfATurn(const PointExperiment& point, double exact_time, uint64_t turn) {
  const BlockResult result = RunBlock(point, BlockOfATurn(point, turn));
  const double mean =
      result.moments.empty() ? *result.batch_means[0].Ratio() : result.moments[0].mean;
  return mean * static_cast<double>(result.samples) / exact_time;
}

double ExactTime(const PointExperiment& point) {
  return *point.FirstEstimate(RunBlock(point, {.samples = 1})).exact;
}

void ShowEngines(const char* name, const ExperimentKind* experiment, double delta, int64_t target) {
  std::vector<Contender> contenders;
  double events = 0;  // of a sample by the reference
  for (const auto& [model, precision] : {std::pair(Model::kBilliardReference, Precision::kDouble),
                                         {Model::kBilliard, Precision::kDouble},
                                         {Model::kBilliard, Precision::kSingle}}) {
    const std::shared_ptr<const PointExperiment> point =
        PointExperiment::Create(Question(experiment, delta, model, precision), 0);
    if (contenders.empty()) events = point->plan().events_per_sample();
    contenders.push_back({"", [point, target, time = ExactTime(*point)](uint64_t turn) {
                            Use(target);
                            return SamplesOfATurn(*point, time, turn);
                          }});
  }
  const Turns turns(contenders, 12);
  std::printf(
      "%-6s %-12s delta %-7g reference %9.0f samples/s (%5.1f million events/s)   "
      "billiard %9.0f: %5.1f times   single: %5.1f times",
      hwy::TargetName(target), name, delta, turns.Best(0), turns.Best(0) * events * 1e-6,
      turns.Best(1), turns.Best(1) / turns.Best(0), turns.Best(2) / turns.Best(0));
  ShowDisturbance(turns);
  std::printf("\n");
}

// Of `threads` threads that share eight pieces of work, work(0) ... work(7), in elapsed time.
double PiecesPerSecond(unsigned threads, const std::function<void(uint64_t)>& work) {
  constexpr uint64_t kPieces = 8;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> running;
  for (unsigned i = 0; i < threads; ++i) {
    running.emplace_back([&work, i, threads] {
      for (uint64_t k = i; k < kPieces; k += threads) work(k);
    });
  }
  for (std::thread& thread : running) thread.join();
  return kPieces / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// How many times as much so many threads do as one.
double Scaling(unsigned threads, const std::function<void(uint64_t)>& work) {
  double one = 0, all = 0;
  for (int turn = 0; turn < 6; ++turn) {
    one = std::max(one, PiecesPerSecond(1, work));
    all = std::max(all, PiecesPerSecond(threads, work));
  }
  return all / one;
}

void ShowThreads(unsigned threads) {
  const auto point = PointExperiment::Create(
      Question(&kFirstHit, 0.0125, Model::kBilliard, Precision::kDouble), 0);
  const double orbits =
      Scaling(threads, [&point](uint64_t k) { RunBlock(*point, BlockOfATurn(*point, k)); });
  const double probe = Scaling(threads, [](uint64_t) { SecondsOfChains<6>(1'000'000); });
  std::printf(
      "first-hit, delta 0.0125: %u threads do %.2f times as much as one\n"
      "independent operations:  %.2f times (less than %u where threads share a core)\n",
      threads, orbits, probe, threads);
}

void ShowClosedForm() {
  constexpr uint64_t kGeometries = 500'000;
  const auto turn_of = [](uint64_t turn) {
    for (uint64_t i = 0; i < kGeometries; ++i) {
      const double delta = 0.1 + 1e-9 * static_cast<double>(turn * kGeometries + i);
      Keep(MeanFreeTimesOf(*PairGeometry::Create(kPaperRho, delta)).ball_piston);
    }
    return double{kGeometries};
  };
  ShowRates({{"closed form: three mean free times", turn_of}}, 12, "");
}

// The definition of core/markov/jump_process.h, with the C library.
double ScalarJumps(uint64_t turn) {
  constexpr int kJumps = 10'000;
  double u = 0.5;
  CounterRandom random(1, 2, turn);
  for (int n = 0; n < kJumps; ++n) {
    const double q = std::sqrt(std::max(1 - 2 * u * u, 0.0)), low = u * std::atan2(u, q);
    Keep(-std::log(random.Uniform()) * M_SQRT2 * M_PI / (q + low));  // the waiting time
    const double g = (q + low) * random.Uniform(), w = g - low;
    u = w < 0 ? std::sqrt((1 - u) * (1 + u)) * std::sin(g / u)
              : std::min(std::sqrt(w * (2 * q - w) + u * u), 1.0);
  }
  return kJumps;
}

double JumpsInLanes(int64_t target) {
  constexpr size_t kWalkers = 1024;
  constexpr int kJumps = 200;
  Use(target);
  JumpWalkers walkers(1, 2, 3, std::vector<double>(kWalkers, 0.5));
  for (int n = 0; n < kJumps; ++n) walkers.Jump();
  Keep(walkers.u()[0]);
  return double{kWalkers * kJumps};
}

// The pair's jump process: its scalar definition, and the lanes.
void ShowJumps() {
  std::vector<Contender> contenders = {{"jumps, scalar", ScalarJumps}};
  for (const int64_t target : VectorTargets()) {
    contenders.push_back({absl::StrCat("jumps, lanes ", hwy::TargetName(target)),
                          [target](uint64_t) { return JumpsInLanes(target); }});
  }
  ShowRates(contenders, 30, " times");
}

void ShowAll() {
  ShowClosedForm();
  ShowJumps();
  for (const int64_t target : VectorTargets()) ShowFlight(target);
  for (const int64_t target : VectorTargets()) {
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
