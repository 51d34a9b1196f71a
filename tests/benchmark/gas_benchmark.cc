// The gas's engines side by side, in one run, on one core: the time of a sample of an experiment,
// wall hits, events and exchanges a second, the bytes of a cell, and how the cost of an exchange or
// a hit grows with the number of cells.
//
//   gas_benchmark
//
// Contenders take turns (turns.h). A row shows medians and ranges of their turns;
// its ratios compare the best turns, which other work disturbs least. Wall hits and the
// pistons' are counted by their exact mean rates.
#include <malloc.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/hit_rates.h"
#include "tests/benchmark/turns.h"
#include "tests/benchmark/vector_targets.h"
#include "tools/flows/paper.h"

namespace ballpiston {
namespace {

double BytesInUse() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

enum class Unit { kBallHits, kAllHits, kExchanges };

// One gas in equilibrium, some time of it in each turn.
class RunningGas {
 public:
  RunningGas(GasEngine engine, int64_t side, double delta, double slice, Unit unit)
      : geometry_(
            GasGeometry::Create(kPaperRho, delta, {side, side, true}, GasEnds::kPeriodic).value()),
        slice_(slice),
        unit_(unit) {
    const GasRandom random(1, 2, 3);
    CounterRandom of_start = random.OfStart();
    // The run takes the state and frees it. So its bytes count from before the state is drawn.
    double before = BytesInUse();
    GasState state = DrawGas(geometry_, TemperatureProfile(1), of_start);
    const double without_meter = BytesInUse();
    meter_ = std::make_unique<GasMeter>(geometry_, state);
    before += BytesInUse() - without_meter;
    std::vector<GasStart> starts;
    starts.push_back({std::move(state), ThermalWalls(), random, meter_.get()});
    run_ = StartGases(engine, geometry_, GasExchangeRate(geometry_, 1), std::move(starts));
    run_->AdvanceTo(time_ = slice / 4);
    bytes_ = (BytesInUse() - before) / static_cast<double>(geometry_.balls());
  }

  // Returns the work of the next slice.
  double Advance() {
    const uint64_t exchanges = meter_->exchanges();
    run_->AdvanceTo(time_ += slice_);
    const HitRates rates = HitRatesOf(geometry_.pair());
    const double ball_hits = slice_ * static_cast<double>(geometry_.balls()) * rates.of_a_ball;
    if (unit_ == Unit::kBallHits) return ball_hits;
    const auto exchanged = static_cast<double>(meter_->exchanges() - exchanges);
    if (unit_ == Unit::kExchanges) return exchanged;
    return exchanged + ball_hits +
           slice_ * static_cast<double>(geometry_.pistons()) * rates.of_a_piston;
  }

  double bytes() const { return bytes_; }
  double hits_of_events() const {  // ball-wall hits among all events
    const double hits = HitRatesOf(geometry_.pair()).of_a_ball;
    return hits / (hits + geometry_.directions() / 2.0 * HitRatesOf(geometry_.pair()).of_a_piston);
  }

 private:
  GasGeometry geometry_;
  double slice_;
  Unit unit_;
  std::unique_ptr<GasMeter> meter_;
  std::unique_ptr<GasRun> run_;
  double time_ = 0;
  double bytes_ = 0;
};

Turns TurnsOf(std::vector<RunningGas>& gases, int turns) {
  std::vector<Contender> contenders;
  for (RunningGas& gas : gases) {
    contenders.push_back({"", [&gas](uint64_t) { return gas.Advance(); }});
  }
  return {contenders, turns};
}

std::vector<double> Millions(std::vector<double> rates) {
  for (double& rate : rates) rate /= 1e6;
  return rates;
}

void ShowSpeed(double delta) {
  std::vector<RunningGas> gases;
  gases.emplace_back(GasEngine::kLanes, 100, delta, 50, Unit::kBallHits);
  gases.emplace_back(GasEngine::kReference, 100, delta, 3, Unit::kAllHits);
  gases.emplace_back(GasEngine::kJumps, 100, delta, 1 / (delta * delta), Unit::kExchanges);
  const Turns turns = TurnsOf(gases, 12);
  std::printf("100x100, delta %-6g", delta);
  ShowMedian("lanes", Millions(turns.Rates(0)), " million wall hits/s");
  ShowMedian("reference", Millions(turns.Rates(1)), " million events/s");
  std::printf(": %.1f times", turns.Best(0) / (turns.Best(1) * gases[1].hits_of_events()));
  ShowMedian("jump process", Millions(turns.Rates(2)), " million exchanges/s");
  ShowDisturbance(turns);
  std::printf("\n");
}

// Samples of an experiment with a chain: a group's first stretches; or replicas, as many as fill
// the lanes of the plan's last chunk.
Block BlockOf(const PointExperiment& point, uint64_t replicas, uint64_t turn) {
  const ChunkPlan& plan = point.plan();
  if (plan.groups() > 0) return plan.BlockAt(turn % plan.groups(), 0);
  return {.chunk = plan.chunks() - 1, .first = turn * replicas, .samples = replicas};
}

void ShowSamples(const ExperimentKind* experiment, int64_t cells, double delta) {
  constexpr int64_t kBalls = 192;  // as many as the lanes fly together
  EnsembleSpec spec = {
      .experiment = experiment,
      .grid = {{kRho, {kPaperRho}}, {kDelta, {delta}}, {kCells, {CodeOf({cells})}}},
      .seed = 5};
  spec.target.samples = 1'000'000;
  if (experiment == &kGasEquilibrium) spec.grid[kTemperature] = {1};
  if (experiment == &kGasConduction) spec.grid[kHot] = {1.5}, spec.grid[kCold] = {0.5};
  std::vector<Contender> contenders;
  const auto add = [&](Model model, int64_t target, int64_t balls, const std::string& name) {
    spec.model = model;
    const std::shared_ptr<const PointExperiment> point = PointExperiment::Create(spec, 0);
    contenders.push_back({name, [=](uint64_t turn) {
                            Use(target);
                            const Block block =
                                BlockOf(*point, static_cast<uint64_t>(balls / cells), turn);
                            RunBlock(*point, block);
                            return static_cast<double>(block.samples);
                          }});
  };
  const std::vector<int64_t> targets = VectorTargets();
  add(Model::kBilliardReference, targets.back(), kBalls / 8, "reference");
  add(Model::kMarkov, targets.back(), kBalls / 8, "jump process");
  for (const int64_t target : targets) {
    add(Model::kBilliard, target, kBalls, absl::StrCat("lanes ", hwy::TargetName(target)));
  }
  const Turns turns(contenders, 12);
  std::printf("%-15s cells %lld, delta %-4g, ms a sample:", std::string(experiment->name).c_str(),
              static_cast<long long>(cells), delta);
  for (size_t i = 0; i < contenders.size(); ++i) {
    std::vector<double> milliseconds = turns.Rates(i);
    for (double& rate : milliseconds) rate = 1e3 / rate;
    ShowMedian(contenders[i].name.c_str(), std::move(milliseconds), "");
    if (i > 1) std::printf(" (%.1f times the reference)", turns.Best(i) / turns.Best(0));
  }
  ShowDisturbance(turns);
  std::printf("\n");
}

// From 32^2 to 1000^2 cells.
void ShowGrowth(const char* name, GasEngine engine, double slice, Unit unit) {
  constexpr double kDelta = 0.025;
  std::vector<RunningGas> gases;
  gases.emplace_back(engine, 32, kDelta, slice * 1000, unit);
  gases.emplace_back(engine, 1000, kDelta, slice, unit);
  const Turns turns = TurnsOf(gases, 8);
  std::printf("%-13s delta %g: %.0f bytes a cell; cost at 1,000,000 cells %.2f times that at 1024",
              name, kDelta, gases[1].bytes(), turns.Best(0) / turns.Best(1));
  ShowDisturbance(turns);
  std::printf("\n");
}

}  // namespace
}  // namespace ballpiston

int main() {
  using ballpiston::ShowSamples, ballpiston::kGasConduction;
  for (const double delta : {0.2, 0.1, 0.05}) {
    ShowSamples(&ballpiston::kGasEquilibrium, 8, delta);
    ShowSamples(&kGasConduction, 1, delta);
    ShowSamples(&kGasConduction, 2, delta);
    if (delta > 0.05) ShowSamples(&kGasConduction, 8, delta);
  }
  for (const double delta : {0.025, 0.05, 0.1, 0.2}) ballpiston::ShowSpeed(delta);
  ballpiston::ShowGrowth("lanes", ballpiston::GasEngine::kLanes, 4, ballpiston::Unit::kBallHits);
  ballpiston::ShowGrowth("jump process", ballpiston::GasEngine::kJumps, 30,
                         ballpiston::Unit::kExchanges);
}
