// The speed of the engines. A row has the rate of wall hits, events, exchanges or samples in a
// second of processor time, and the time of one of them (`each`). Rows of one kind can be compared:
// the reference, the lanes with each kind of vector instructions, and the method of most
// billiard codes. A row that names no vector instructions has the widest of the machine.
//
//   engine_benchmark [FLAG_OF_GOOGLE_BENCHMARK...]
//
// `make bench` repeats the rows in random order, and prints the median and the scatter of each.
#include <benchmark/benchmark.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/lane_frame.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/gas/hit_rates.h"
#include "core/gpu/device_orbits.h"
#include "core/markov/jump_process.h"
#include "core/sampling/direction.h"
#include "tests/core/one_point_spec.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/paper.h"

namespace ballpiston {
namespace {

// ---- rows ----

using Work = std::function<double(uint64_t turn)>;  // returns how much it has done

// The kinds of vector instructions of this machine, from SSE4 on, the widest last.
std::vector<int64_t> VectorTargets() {
  std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  std::erase_if(targets, [](int64_t target) { return target > HWY_SSE4; });
  std::reverse(targets.begin(), targets.end());
  return targets;
}

// The lanes that begin in `work` use the instructions `target`.
benchmark::internal::Benchmark* AddRow(const std::string& name, const Work& work,
                                       int64_t target = VectorTargets().back()) {
  return benchmark::RegisterBenchmark(name.c_str(), [work, target](benchmark::State& state) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    uint64_t turn = 0;
    work(turn++);  // makes tables and gases
    double done = 0;
    for (auto _ : state) done += work(turn++);
    using benchmark::Counter;
    state.counters["rate"] = Counter(done, Counter::kIsRate);
    state.counters["each"] = Counter(done, Counter::kIsRate | Counter::kInvert);
  });
}

// A row for each kind of vector instructions.
void AddRowsOfLanes(const std::string& name, const Work& work) {
  for (const int64_t target : VectorTargets()) {
    AddRow(absl::StrCat(name, "/", hwy::TargetName(target)), work, target);
  }
}

// ---- closed form, jump process ----

double MeanFreeTimesOfAGeometry(uint64_t turn) {
  const double delta = 0.1 + 1e-9 * static_cast<double>(turn);
  benchmark::DoNotOptimize(MeanFreeTimesOf(*PairGeometry::Create(kPaperRho, delta)).ball_piston);
  return 1;
}

// The definition of core/markov/jump_process.h, with the C library.
double ScalarJumps(uint64_t turn) {
  constexpr int kJumps = 10'000;
  double u = 0.5;
  CounterRandom random(1, 2, turn);
  for (int n = 0; n < kJumps; ++n) {
    const double q = std::sqrt(std::max(1 - 2 * u * u, 0.0)), low = u * std::atan2(u, q);
    benchmark::DoNotOptimize(-std::log(random.Uniform()) * M_SQRT2 * M_PI / (q + low));  // the wait
    const double g = (q + low) * random.Uniform(), w = g - low;
    u = w < 0 ? std::sqrt((1 - u) * (1 + u)) * std::sin(g / u)
              : std::min(std::sqrt(w * (2 * q - w) + u * u), 1.0);
  }
  return kJumps;
}

double JumpsInLanes(uint64_t) {
  constexpr size_t kWalkers = 1024;
  constexpr int kJumps = 200;
  JumpWalkers walkers(1, 2, 3, std::vector<double>(kWalkers, 0.5));
  for (int n = 0; n < kJumps; ++n) walkers.Jump();
  benchmark::DoNotOptimize(walkers.u()[0]);
  return double{kWalkers * kJumps};
}

// ---- flights of the ball alone ----

constexpr uint64_t kBalls = 128;  // as many as the widest lanes have

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

Work HitsInLanes(FlyLanes* fly) {
  return [fly](uint64_t turn) {
    constexpr uint64_t kHits = 100'000;
    fly(*PairGeometry::Create(kPaperRho, 0.05), BallsFromTheMiddleOfAnArc(turn), kHits, {});
    return double{kHits * kBalls};
  };
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
  constexpr uint64_t kHits = 500'000;
  const LaneFrame start = BallsFromTheMiddleOfAnArc(turn)[0];
  Eigen::Vector2d position = PositionInCell(start), direction = DirectionInCell(start);
  int left = -1;  // the disc
  for (uint64_t hit = 0; hit < kHits; ++hit) Fly(position, direction, left);
  benchmark::DoNotOptimize(position.x());
  return kHits;
}

// ---- experiments with a pair ----

using Point = std::shared_ptr<const PointExperiment>;

Point PairPoint(const ExperimentKind* experiment, double delta, Model model, Precision precision) {
  EnsembleSpec spec =
      experiment == &kEquilibrium
          ? SpecOf(experiment, PaperPoint(delta), {.collisions = 100'000'000}, model, 5)
          : SpecOf(experiment, PaperPoint(delta, 0.125, 1), {.samples = 10'000'000}, model, 5);
  spec.precision = precision;
  return PointExperiment::Create(spec, 0);
}

// Samples in blocks of some 50 ms: a block of the reference has fewer. They are counted by their
// flight time, in which blocks of the same size differ.
Work PairSamples(const Point& point) {
  const double events = point->answer().model == Model::kBilliardReference ? 0x1p20 : 0x1p24;
  const uint64_t samples =
      std::max(static_cast<uint64_t>(events / point->plan().events_per_sample()), uint64_t{1});
  const double exact = *point->FirstEstimate(RunBlock(*point, {.samples = 1})).exact;
  return [=](uint64_t turn) {
    const BlockResult result = RunBlock(*point, {.first = turn * samples, .samples = samples});
    const double mean =
        result.moments.empty() ? *result.batch_means[0].Ratio() : result.moments[0].mean;
    return mean * static_cast<double>(result.samples) / exact;
  };
}

void AddPair(const ExperimentKind* experiment, double delta) {
  const auto work = [&](Model model, Precision precision) {
    return PairSamples(PairPoint(experiment, delta, model, precision));
  };
  const std::string name = absl::StrCat(experiment->name, "/delta:", delta);
  AddRow(name + "/reference", work(Model::kBilliardReference, Precision::kDouble));
  AddRowsOfLanes(name + "/lanes", work(Model::kBilliard, Precision::kDouble));
  AddRowsOfLanes(name + "/lanes_single", work(Model::kBilliard, Precision::kSingle));
}

// The blocks of a point whose flights a GPU computes.
class BlocksForDevice : public BlockQueue {
 public:
  BlocksForDevice(LocalPoint& point, OrbitDevice* device) : point_(point), device_(device) {}
  std::optional<Block> Next() override { return point_.NextBlock(); }
  void Done(const Block& block, BlockResult result) override {
    point_.Add(block, std::move(result));
  }
  bool Pause() override { return point_.finished(); }
  OrbitDevice* device() const override { return device_; }

 private:
  LocalPoint& point_;
  OrbitDevice* device_;
};

Work SamplesOnDevice(int threads) {
  const auto fail = [](const absl::Status& status) { throw std::runtime_error(status.ToString()); };
  const auto device = std::make_shared<OrbitsOnDevice>(*OpenCuda(), threads, fail);
  const Point point = PointExperiment::Create(
      SpecOf(&kFirstHit, PaperPoint(0.0125, 0.125, 1), {.samples = 1'000'000}, Model::kBilliard),
      0);
  return [=](uint64_t) {
    LocalPoint local(*point, ChunkFold::WindowFor(point->plan(), device->orbits()));
    BlocksForDevice blocks(local, device.get());
    const auto run = point->StartRun(blocks);
    while (!local.finished()) {
      if (run->Advance()) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return static_cast<double>(local.Merged().samples);
  };
}

// The samples of several threads that share the processor, and a GPU if there is one, by the clock
// on the wall.
void AddThreads() {
  const Work work =
      PairSamples(PairPoint(&kFirstHit, 0.0125, Model::kBilliard, Precision::kDouble));
  const int cores = std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
  AddRow("first-hit/delta:0.0125/lanes", work)->ThreadRange(1, cores)->UseRealTime();
  for (int threads = 1; OpenCuda().ok() && threads <= cores; threads *= 2) {
    AddRow("first-hit/delta:0.0125/device", SamplesOnDevice(threads))
        ->Threads(threads)
        ->UseRealTime();
  }
}

// ---- experiments with a chain ----

void AddGas(const ExperimentKind* experiment, int64_t cells, double delta) {
  constexpr int64_t kBallsTogether = 192;  // as many as the lanes fly together
  PointParameters point = PaperGas(experiment, delta, {cells});
  if (experiment == &kGasEquilibrium) point.Set(kTemperature, 1);
  // A group's first stretches; or replicas, as many as fill the lanes of the plan's last chunk.
  const auto work = [&](Model model, int64_t balls) -> Work {
    const Point made =
        PointExperiment::Create(SpecOf(experiment, point, {.samples = 1'000'000}, model, 5), 0);
    return [made, replicas = static_cast<uint64_t>(balls / cells)](uint64_t turn) {
      const ChunkPlan& plan = made->plan();
      const Block block =
          plan.groups() > 0
              ? plan.BlockAt(turn % plan.groups(), 0)
              : Block{.chunk = plan.chunks() - 1, .first = turn * replicas, .samples = replicas};
      RunBlock(*made, block);
      return static_cast<double>(block.samples);
    };
  };
  const std::string name = absl::StrCat(experiment->name, "/cells:", cells, "/delta:", delta);
  AddRow(name + "/reference", work(Model::kBilliardReference, kBallsTogether / 8));
  AddRow(name + "/jumps", work(Model::kMarkov, kBallsTogether / 8));
  AddRowsOfLanes(name + "/lanes", work(Model::kBilliard, kBallsTogether));
}

// ---- a lattice of 100 x 100 cells in equilibrium ----

class Lattice {
 public:
  Lattice(GasEngine engine, double delta)
      : geometry_(
            GasGeometry::Create(kPaperRho, delta, {100, 100, true}, GasEnds::kPeriodic).value()) {
    const GasRandom random(1, 2, 3);
    CounterRandom of_start = random.OfStart();
    GasState state = DrawGas(geometry_, TemperatureProfile(1), of_start);
    std::vector<GasStart> starts;
    starts.push_back({std::move(state), ThermalWalls(), random});
    run_ = StartGases(engine, geometry_, GasExchangeRate(geometry_, 1), std::move(starts));
  }

  // Returns the number of exchanges.
  double Advance(double duration) {
    const uint64_t before = Exchanges();
    run_->AdvanceTo(time_ += duration);
    return static_cast<double>(Exchanges() - before);
  }

  // By their exact mean rates.
  double BallHits(double duration) const {
    return duration * static_cast<double>(geometry_.balls()) *
           HitRatesOf(geometry_.pair()).of_a_ball;
  }
  double PistonHits(double duration) const {
    return duration * static_cast<double>(geometry_.pistons()) *
           HitRatesOf(geometry_.pair()).of_a_piston;
  }

 private:
  uint64_t Exchanges() const { return run_->meters().front().exchanges(); }

  GasGeometry geometry_;
  std::unique_ptr<GasRun> run_;
  double time_ = 0;
};

void AddLattice(double delta) {
  const auto add = [delta](const char* name, GasEngine engine, const auto& advance) {
    AddRow(absl::StrCat("lattice/delta:", delta, "/", name),
           [=, lattice = std::shared_ptr<Lattice>()](uint64_t) mutable {
             if (lattice == nullptr) lattice = std::make_shared<Lattice>(engine, delta);
             return advance(*lattice);
           });
  };
  add("lanes_wall_hits", GasEngine::kLanes, [](Lattice& lattice) {
    constexpr double kDuration = 5;
    lattice.Advance(kDuration);
    return lattice.BallHits(kDuration);
  });
  add("reference_events", GasEngine::kReference, [](Lattice& lattice) {
    constexpr double kDuration = 0.5;
    return lattice.Advance(kDuration) + lattice.BallHits(kDuration) + lattice.PistonHits(kDuration);
  });
  add("jumps_exchanges", GasEngine::kJumps,
      [delta](Lattice& lattice) { return lattice.Advance(0.1 / (delta * delta)); });
}

void AddAll() {
  AddRow("closed_form/three_mean_free_times", MeanFreeTimesOfAGeometry);
  AddRow("jumps/scalar", ScalarJumps);
  AddRowsOfLanes("jumps/lanes", JumpsInLanes);
  AddRow("wall_hits/scalar", ScalarHits);
  AddRowsOfLanes("wall_hits/lanes", HitsInLanes(FlyLaneBalls));
  AddRowsOfLanes("wall_hits/lanes_single", HitsInLanes(FlyLaneBallsSingle));
  AddPair(&kFirstHit, 0.0125);
  AddPair(&kFirstHit, 0.05);
  AddPair(&kFirstHit, 0.2);
  AddPair(&kEquilibrium, 0.05);
  AddPair(&kEquilibrium, 0.2);
  for (const double delta : {0.2, 0.1, 0.05}) {
    AddGas(&kGasEquilibrium, 8, delta);
    for (const int64_t cells : {1, 2, 8}) {
      if (cells < 8 || delta > 0.05) AddGas(&kGasConduction, cells, delta);
    }
  }
  for (const double delta : {0.025, 0.05, 0.1, 0.2}) AddLattice(delta);
  AddThreads();
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  ballpiston::AddAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
