#include "core/experiment/gas_experiment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/ensemble/chunk_plan.h"
#include "core/experiment/pair_experiment.h"
#include "core/experiment/sampled_estimate.h"
#include "core/experiment/without_last_bits.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_shape.h"
#include "core/gas/hit_rates.h"

namespace ballpiston {
namespace {

// The lanes need this many balls to be full.
constexpr int64_t kBallsInLanes = 192;

uint64_t ReplicasThatFillLanes(int64_t balls) {
  return static_cast<uint64_t>((kBallsInLanes + balls - 1) / balls);
}

// Replicas that a thread computes at the same time: at most a quarter of those of the chunk, so
// that several threads share even a small chunk.
uint64_t TogetherInLanes(int64_t balls, const ChunkPlan& plan, uint64_t chunk) {
  return std::clamp<uint64_t>(plan.SamplesIn(chunk) / 4, 1, ReplicasThatFillLanes(balls));
}

// A block whose replicas are being computed. The meters are kept until all replicas are done, so
// that results are added in the order of the replicas.
struct OpenBlock {
  Block block;
  std::vector<std::unique_ptr<GasMeter>> meters = {};  // of the replicas that have been started
  std::vector<double> energies = {};                   // at their starts
  uint64_t done = 0;
  BlockResult result = {};    // of the replicas that have been measured
  size_t measured_parts = 0;  // of the next replica
};

// The draw of a replica's start.
struct StartDraw {
  StartDraw(const GasExperiment& experiment, const GasRandom& random)
      : random(random),
        of_start(random.OfStart()),
        draw(experiment.geometry(), experiment.TemperaturesAtStart(), of_start) {}

  GasRandom random;
  CounterRandom of_start;
  GasDraw draw;
  GasState state = {};  // once it is drawn
  GasMeter* meter = nullptr;
};

// Computes several replicas at a time, of several blocks if these are small, to fill the lanes.
class GasBlocks : public BlockRun {
 public:
  GasBlocks(const GasExperiment& experiment, BlockQueue& queue)
      : experiment_(experiment), queue_(queue) {}

  bool Advance() override {
    Pauses pauses([this] { return queue_.Pause(); });
    do {
      if (stage_ == Stage::kBeginning && !Begin(pauses)) return false;
      if (stage_ == Stage::kBeginning) return true;
      if (!RunToTheEnd(pauses) || !Finish(pauses)) return false;
    } while (!queue_.Pause());
    return false;
  }

 private:
  enum class Stage { kBeginning, kRelaxing, kMeasuring, kFinishing };

  // The other engines run one replica at a time, because more would not make them faster.
  size_t MostTogether(const Block& block) const {
    if (experiment_.gas_engine() != GasEngine::kLanes) return 1;
    return TogetherInLanes(experiment_.geometry().balls(), experiment_.plan(), block.chunk);
  }

  // Starts replicas until there are enough, if the queue has any. These functions return false at a
  // pause.
  bool Begin(Pauses& pauses) {
    while (draw_ != nullptr || (!IsFull() && HasNext())) {
      if (draw_ == nullptr) BeginDraw();
      if (!Draw(pauses)) return false;
    }
    if (starts_.empty()) return true;
    run_ = StartGases(experiment_.gas_engine(), experiment_.geometry(), experiment_.exchange_rate(),
                      std::exchange(starts_, {}));
    stage_ = Stage::kRelaxing;
    return true;
  }

  bool IsFull() const { return !starts_.empty() && starts_.size() >= most_together_; }

  bool HasNext() {
    if (!open_.empty() && open_.back()->meters.size() < open_.back()->block.samples) return true;
    const std::optional<Block> block = queue_.Next();
    if (block) {
      open_.push_back(std::make_unique<OpenBlock>(
          OpenBlock{.block = *block, .result = experiment_.EmptyResult()}));
    }
    return block.has_value();
  }

  // The first replica determines the number of replicas in the run.
  void BeginDraw() {
    const OpenBlock& open = *open_.back();
    if (starts_.empty()) most_together_ = MostTogether(open.block);
    draw_ = std::make_unique<StartDraw>(
        experiment_, experiment_.RandomOf(open.block.first + open.meters.size()));
  }

  bool Draw(Pauses& pauses) {
    if (draw_->meter == nullptr) {
      if (!draw_->draw.Advance(pauses)) return false;
      draw_->state = draw_->draw.Take();
      open_.back()->meters.push_back(std::make_unique<GasMeter>(experiment_.geometry()));
      draw_->meter = open_.back()->meters.back().get();
    }
    if (!draw_->meter->Place(draw_->state, pauses)) return false;
    draw_->meter->MeasureCurrent(experiment_.CurrentOf(draw_->state));
    open_.back()->energies.push_back(draw_->meter->TotalEnergy());
    running_.push_back(draw_->meter);
    const GasRandom& random = draw_->random;
    starts_.push_back({std::move(draw_->state), experiment_.WallsOf(random), random, draw_->meter});
    draw_.reset();
    return true;
  }

  bool RunToTheEnd(Pauses& pauses) {
    const GasTimes& times = experiment_.times();
    if (stage_ == Stage::kRelaxing) {
      const auto begin = [&](GasMeter& meter) { return meter.Begin(times.relax, pauses); };
      if (!run_->AdvanceTo(times.relax, pauses) || !ForEachRunning(begin)) return false;
      stage_ = Stage::kMeasuring;
    }
    if (stage_ == Stage::kMeasuring) {
      const auto end = [&](GasMeter& meter) { return meter.End(times.Total(), pauses); };
      if (!run_->AdvanceTo(times.Total(), pauses) || !ForEachRunning(end)) return false;
      run_.reset();
      CountDone(std::exchange(running_, {}).size());
      stage_ = Stage::kFinishing;
    }
    return true;
  }

  // Calls step(meter) for the meters of all replicas that run, until it returns false.
  template <typename Step>
  bool ForEachRunning(const Step& step) {
    for (; next_meter_ < running_.size(); ++next_meter_) {
      if (!step(*running_[next_meter_])) return false;
    }
    next_meter_ = 0;
    return true;
  }

  // Replicas were started in the order of their blocks.
  void CountDone(size_t replicas) {
    for (const auto& open : open_) {
      const uint64_t more = std::min<uint64_t>(replicas, open->meters.size() - open->done);
      open->done += more;
      replicas -= more;
    }
  }

  bool Finish(Pauses& pauses) {
    while (!open_.empty() && open_.front()->done == open_.front()->block.samples) {
      if (!Measure(*open_.front(), pauses)) return false;
      const std::unique_ptr<OpenBlock> open = std::move(open_.front());
      open_.erase(open_.begin());
      queue_.Done(open->block, std::move(open->result));
    }
    stage_ = Stage::kBeginning;
    return true;
  }

  bool Measure(OpenBlock& open, Pauses& pauses) const {
    const auto bodies =
        static_cast<double>(experiment_.geometry().balls() + experiment_.geometry().pistons());
    const size_t parts = experiment_.MeasuredParts();
    const double nanoseconds = kToMeasureABody * bodies / static_cast<double>(parts);
    while (open.result.samples < open.block.samples) {
      const size_t replica = open.result.samples;
      const GasMeter& meter = *open.meters[replica];
      if (!ForEachWithPauses(open.measured_parts, parts, nanoseconds, pauses, [&](size_t part) {
            experiment_.MeasurePart(part, meter, open.result);
          })) {
        return false;
      }
      open.measured_parts = 0;
      AddHealth(meter, open.energies[replica], open.result.health);
      ++open.result.samples;
    }
    return true;
  }

  void AddHealth(const GasMeter& meter, double energy_at_start, Health& health) const {
    Health of_replica = {.escapes = meter.escapes()};
    if (experiment_.geometry().ends() == GasEnds::kPeriodic) {
      of_replica.max_energy_error = std::fabs(meter.TotalEnergy() / energy_at_start - 1);
    }
    health.Merge(of_replica);
  }

  const GasExperiment& experiment_;
  BlockQueue& queue_;
  std::vector<std::unique_ptr<OpenBlock>> open_;
  std::unique_ptr<StartDraw> draw_;  // of the next replica, if begun
  std::vector<GasStart> starts_;
  size_t most_together_ = 0;
  std::vector<GasMeter*> running_;
  size_t next_meter_ = 0;
  std::unique_ptr<GasRun> run_;
  Stage stage_ = Stage::kBeginning;

  static constexpr double kToMeasureABody = 20;  // nanoseconds
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
  } else {
    CheckBilliardDomain(spec, found);
  }
}

// Factors measured with chains of 1 to 10^4 cells and lattices to 1000x1000, at deltas from 0.0125
// to 0.2. In lanes a wall hit costs as much as 2.6 of the pair's. An exchange, after which two
// balls fly again, costs as much as a collision of the pair and 345 wall hits, and 360 more shared
// by the replicas that run together, whose balls fly together. A hit of a thermal wall, after which
// one ball flies again, costs 110 wall hits. An event of the reference costs as much as 2.6 of the
// pair's events with 16 bodies in the queue, and 6.6 with 20,000. An exchange of the jump process
// costs as much as 2.1 of the pair's jumps, which are measured with their correlations.
//
// Each visit of a ball to a piston's reach costs 6 wall hits, and there are about stroke/delta
// visits for an exchange. In a gas beyond the processor's caches an exchange costs up to 2300 more.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time) {
  const auto balls = static_cast<double>(geometry.balls());
  const auto pistons = static_cast<double>(geometry.pistons());
  const double exchanges =
      static_cast<double>(geometry.contacts()) * InfiniteGasExchangeRate(geometry, 1) * time;
  if (model == Model::kMarkov) return {.starts = balls, .jumps = 2.1 * exchanges, .together = 1};
  const HitRates rates = HitRatesOf(geometry.pair());
  const double ball_hits = rates.of_a_ball * balls * time;
  if (model == Model::kBilliardReference) {
    const double event = 1 + 1.3 * std::log10(balls + pistons);
    return {.ball_wall = event * ball_hits,
            .piston_wall = event * rates.of_a_piston * pistons * time,
            .collisions = event * exchanges,
            .starts = balls,
            .together = 1};
  }
  const double thermal_hits = ThermalHitsOf(geometry, rates) * time;
  constexpr double kBeyondTheCaches = 7e5;  // balls
  const double uncached = balls / (balls + kBeyondTheCaches);
  const double visits = geometry.pair().stroke() / geometry.pair().delta();
  SampleWork work = {.ball_wall = 2.6 * ball_hits + 345 * exchanges + 110 * thermal_hits,
                     .collisions = exchanges,
                     .starts = balls};
  const ChunkPlan plan(kMaxSamples, Engine::kLanes, work.Events());
  work.together = static_cast<double>(TogetherInLanes(geometry.balls(), plan, 0));
  work.delays = exchanges * (360 / work.together + 6 * visits + 2300 * uncached);
  return work;
}

// Measured with gases of 10^6 cells, chains and lattices: by the lanes 297 bytes for a ball and 64
// for a piston, by the reference 206 and 92, by the jump process 77 and 54. Lists that grow may be
// half empty, so the bound is twice that. The rest is for the meters of small gases, of which a
// block has thousands.
double MemoryOfReplicas(Model model, const PointParameters& point) {
  constexpr double kOfABlock = 10e6;
  constexpr double kLanes[] = {594, 128}, kReference[] = {412, 184}, kJumps[] = {154, 108};
  const bool in_lanes = model != Model::kMarkov && model != Model::kBilliardReference;
  const double* const bytes = in_lanes ? kLanes : model == Model::kMarkov ? kJumps : kReference;
  const GasShape shape = ShapeOf(point[kCells]);
  // A piston for every contact along +x and +y, and one more in each row between reservoirs.
  const auto balls = static_cast<double>(shape.cells());
  const double pistons = static_cast<double>(shape.contacts() / 2 + shape.rows);
  const double together = in_lanes ? static_cast<double>(ReplicasThatFillLanes(shape.cells())) : 1;
  return kOfABlock + together * (balls * bytes[0] + pistons * bytes[1]);
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
