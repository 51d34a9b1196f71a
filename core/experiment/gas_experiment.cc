#include "core/experiment/gas_experiment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/experiment/pair_experiment.h"
#include "core/experiment/sampled_estimate.h"
#include "core/experiment/without_last_bits.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_shape.h"
#include "core/gas/hit_rates.h"

namespace ballpiston {
namespace {

// A block whose replicas are being computed. The meters are kept until all replicas are done, so
// that results are added in the order of the replicas.
struct OpenBlock {
  Block block;
  std::vector<std::unique_ptr<GasMeter>> meters = {};  // of the replicas that have been started
  std::vector<double> energies = {};                   // at their starts
  uint64_t done = 0;
};

// Computes several replicas at a time, of several blocks if these are small, to fill the lanes.
class GasBlocks : public BlockRun {
 public:
  GasBlocks(const GasExperiment& experiment, BlockQueue& queue)
      : experiment_(experiment), queue_(queue) {}

  bool Advance() override {
    do {
      if (run_ == nullptr && !Begin()) return true;
      AdvanceSlice();
    } while (!queue_.Pause());
    return false;
  }

 private:
  // The lanes need this many balls to be full. The other engines run one replica at a time, because
  // more replicas would not make them faster.
  int64_t BallsTogether() const {
    constexpr int64_t kOfLanes = 1536;
    return experiment_.gas_engine() == GasEngine::kLanes ? kOfLanes : 1;
  }

  static constexpr double kSecondsOfASlice = 0.01;

  // Takes replicas until there are enough balls. Returns false if there are none.
  bool Begin() {
    std::vector<GasStart> starts;
    const int64_t each = experiment_.geometry().balls();
    for (int64_t balls = 0; balls < BallsTogether() && HasNext(); balls += each) {
      starts.push_back(Start());
    }
    if (starts.empty()) return false;
    const double seconds = experiment_.plan().SecondsFor(static_cast<double>(starts.size()));
    slice_ = experiment_.times().Total() / std::ceil(seconds / kSecondsOfASlice);
    time_ = 0;
    is_measuring_ = false;
    run_ = StartGases(experiment_.gas_engine(), experiment_.geometry(), experiment_.exchange_rate(),
                      std::move(starts));
    return true;
  }

  bool HasNext() {
    if (!open_.empty() && open_.back()->meters.size() < open_.back()->block.samples) return true;
    const std::optional<Block> block = queue_.Next();
    if (block) open_.push_back(std::make_unique<OpenBlock>(OpenBlock{*block}));
    return block.has_value();
  }

  GasStart Start() {
    OpenBlock& open = *open_.back();
    const GasRandom random = experiment_.RandomOf(open.block.first + open.meters.size());
    CounterRandom of_start = random.OfStart();
    GasState state = experiment_.Draw(of_start);
    open.meters.push_back(std::make_unique<GasMeter>(experiment_.geometry(), state));
    GasMeter* const meter = open.meters.back().get();
    meter->MeasureCurrent(experiment_.CurrentOf(state));
    open.energies.push_back(meter->TotalEnergy());
    running_.push_back(meter);
    return {std::move(state), experiment_.WallsOf(random), random, meter};
  }

  void AdvanceSlice() {
    const GasTimes& times = experiment_.times();
    const double end = is_measuring_ ? times.Total() : times.relax;
    time_ = std::min(time_ + slice_, end);
    run_->AdvanceTo(time_);
    if (time_ < end) return;
    if (is_measuring_) return Finish();
    is_measuring_ = true;
    for (GasMeter* const meter : running_) meter->Begin(time_);
  }

  // Replicas were started in the order of their blocks.
  void Finish() {
    run_.reset();
    for (GasMeter* const meter : running_) meter->End(time_);
    size_t left = std::exchange(running_, {}).size();
    for (const auto& open : open_) {
      const uint64_t more = std::min<uint64_t>(left, open->meters.size() - open->done);
      open->done += more;
      left -= more;
    }
    while (!open_.empty() && open_.front()->done == open_.front()->block.samples) {
      const std::unique_ptr<OpenBlock> open = std::move(open_.front());
      open_.erase(open_.begin());
      queue_.Done(open->block, ResultOf(*open));
    }
  }

  BlockResult ResultOf(const OpenBlock& open) const {
    BlockResult result = experiment_.EmptyResult();
    for (size_t i = 0; i < open.meters.size(); ++i) {
      const GasMeter& meter = *open.meters[i];
      Health health = {.escapes = meter.escapes()};
      if (experiment_.geometry().ends() == GasEnds::kPeriodic) {
        health.max_energy_error = std::fabs(meter.TotalEnergy() / open.energies[i] - 1);
      }
      result.health.Merge(health);
      ++result.samples;
      experiment_.Measure(meter, result);
    }
    return result;
  }

  const GasExperiment& experiment_;
  BlockQueue& queue_;
  std::vector<std::unique_ptr<OpenBlock>> open_;
  std::vector<GasMeter*> running_;
  std::unique_ptr<GasRun> run_;
  double slice_ = 0;
  double time_ = 0;
  bool is_measuring_ = false;
};

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
  }
}

// Factors measured with chains of 8, 100 and 10^4 cells and with 16x16, at deltas from 0.025 to
// 0.2. In lanes a wall hit costs as much as four of the pair's, and an exchange, after which two
// balls fly again, as much as a collision of the pair and 900 wall hits. A hit of a thermal wall,
// after which one ball flies again, costs 1000 wall hits. An event of the reference costs as much
// as 2.6 of the pair's events with 16 bodies in the queue, and 6.6 with 20,000. An exchange of the
// jump process costs as much as 2.6 of the pair's jumps, which are measured with their
// correlations.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time) {
  const auto balls = static_cast<double>(geometry.balls());
  const auto pistons = static_cast<double>(geometry.pistons());
  const double exchanges =
      static_cast<double>(geometry.contacts()) * InfiniteGasExchangeRate(geometry, 1) * time;
  if (model == Model::kMarkov) return {.starts = balls, .jumps = 2.6 * exchanges};
  const HitRates rates = HitRatesOf(geometry.pair());
  const double ball_hits = rates.of_a_ball * balls * time;
  if (model == Model::kBilliardReference) {
    const double event = 1 + 1.3 * std::log10(balls + pistons);
    return {.ball_wall = event * ball_hits,
            .piston_wall = event * rates.of_a_piston * pistons * time,
            .collisions = event * exchanges,
            .starts = balls};
  }
  const double thermal_hits = ThermalHitsOf(geometry, rates) * time;
  return {.ball_wall = 4 * ball_hits + 900 * exchanges + 1000 * thermal_hits,
          .collisions = exchanges,
          .starts = balls};
}

GasExperiment::GasExperiment(const EnsembleSpec& spec, const PointParameters& point,
                             const GasGeometry& geometry, const GasTimes& times)
    : PointExperiment(spec, point),
      geometry_(geometry),
      times_{.relax = WithoutLastBits(times.relax),
             .measure = WithoutLastBits(times.measure),
             .share = times.share},
      exchange_rate_(WithoutLastBits(GasExchangeRate(geometry, 1))) {}

GasEngine GasExperiment::gas_engine() const {
  switch (answer().model) {
    case Model::kMarkov:
      return GasEngine::kJumps;
    case Model::kBilliardReference:
      return GasEngine::kReference;
    default:
      return GasEngine::kLanes;
  }
}

void GasExperiment::AddMeans(const GasMeter& meter, size_t first, BlockResult& result) const {
  result.batch_means[first].Add(static_cast<double>(meter.exchanges()),
                                static_cast<double>(geometry_.contacts()) * meter.duration());
  double balls = 0, pistons = 0;
  for (size_t i = 0; i < meter.bodies(); ++i) {
    (i < meter.balls() ? balls : pistons) += meter.MeanEnergy(i);
  }
  result.batch_means[first + 1].Add(balls, static_cast<double>(geometry_.balls()));
  result.batch_means[first + 2].Add(2 * pistons, static_cast<double>(geometry_.pistons()));
}

Estimate GasExperiment::Scaled(Estimate measured, double scale) const {
  measured.value *= scale;
  if (times_.share < 1) measured.standard_error.reset();
  if (measured.standard_error) *measured.standard_error *= scale;
  return measured;
}

Estimate GasExperiment::Mean(const char* name, const BlockResult& merged, size_t index,
                             double scale) const {
  return Scaled(SampledRatio(name, merged.batch_means[index], static_cast<double>(merged.samples)),
                scale);
}

Estimate GasExperiment::Mean(const char* name, const Moments& measured, double scale,
                             double events_per_replica) const {
  const double events = events_per_replica * static_cast<double>(measured.count);
  return Scaled(SampledMean(name, measured, events), scale);
}

std::unique_ptr<BlockRun> GasExperiment::StartRun(BlockQueue& queue) const {
  return std::make_unique<GasBlocks>(*this, queue);
}

}  // namespace ballpiston
