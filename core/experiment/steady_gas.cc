#include "core/experiment/steady_gas.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_run.h"
#include "core/statistics/batch_means.h"
#include "core/statistics/moments.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {
namespace {

// Computes chunks, each of which is a block: some stretches of all trajectories of a group, which
// run together.
class GroupRun : public EngineRun {
 public:
  GroupRun(const SteadyGas& experiment, BlockQueue& queue)
      : experiment_(experiment), queue_(queue) {}

  bool Advance() override {
    do {
      if (!block_ && !Begin()) return true;
      if (!run_->AdvanceToward((stretches_ + 1) * experiment_.stretch())) continue;
      EndStretch();
      if (stretches_ < StretchesOfBlock()) {
        BeginStretch();
      } else {
        BlockResult result = Result();
        queue_.Done(*std::exchange(block_, std::nullopt), std::move(result));
      }
    } while (!queue_.Pause());
    return false;
  }

 private:
  std::vector<SteadyTrajectory>& trajectories() { return group_.trajectories; }
  double Now() const { return stretches_ * experiment_.stretch(); }
  double StretchesOfBlock() const {
    return static_cast<double>(block_->samples / experiment_.shape().trajectories);
  }
  // The random numbers of a trajectory in this chunk.
  GasRandom RandomOf(size_t trajectory) const {
    return experiment_.RandomOf(block_->chunk * experiment_.shape().trajectories + trajectory);
  }

  // Returns false if the queue has no block.
  bool Begin() {
    block_ = queue_.Next();
    if (!block_) return false;
    const SteadyShape& shape = experiment_.shape();
    const bool is_first = block_->start.empty();
    group_ = is_first ? shape.NewGroup() : shape.Read(block_->start);
    if (is_first) DrawStarts();
    stretches_ = 0;
    is_measuring_ = group_.measured > 0 || (group_.stretches >= WarmUp() && JudgeWarmUp());
    Start();
    return true;
  }

  void DrawStarts() {
    for (size_t i = 0; i < trajectories().size(); ++i) {
      CounterRandom of_start = RandomOf(i).OfStart();
      SteadyTrajectory& trajectory = trajectories()[i];
      trajectory.state =
          DrawGas(experiment_.geometry(), experiment_.TemperaturesAtStart(), of_start);
      trajectory.energy = EnergyOf(trajectory.state);
    }
  }

  void Start() {
    std::vector<GasStart> starts;
    for (size_t i = 0; i < trajectories().size(); ++i) {
      const GasRandom random = RandomOf(i);
      starts.push_back({std::move(trajectories()[i].state), experiment_.WallsOf(random), random});
    }
    carried_.assign(starts.size(), 0);
    run_ = StartGases(experiment_.gas_engine(), experiment_.geometry(), experiment_.exchange_rate(),
                      std::move(starts));
  }

  // Begins a stretch after the chunk's first one. Within a chunk the warm-up is judged only once,
  // at its minimum length; later at the beginning of a chunk.
  void BeginStretch() {
    if (is_measuring_ || group_.stretches != WarmUp()) return;
    is_measuring_ = JudgeWarmUp();
    if (!is_measuring_) return;
    for (GasMeter& meter : run_->meters()) meter.Begin(Now());
  }

  double WarmUp() const { return static_cast<double>(experiment_.trajectories().warm_up); }

  // Decides whether the warm-up ends now, and stores the energies for the next decision. At the
  // beginning of a chunk it takes the energies of the states, because the run of the jump process
  // sets the energies of its outermost pistons, which changes them by rounding.
  bool JudgeWarmUp() {
    double change = 0;
    for (size_t i = 0; i < trajectories().size(); ++i) {
      SteadyTrajectory& trajectory = trajectories()[i];
      const double energy =
          run_ == nullptr ? EnergyOf(trajectory.state) : run_->meters()[i].TotalEnergy();
      change += energy - std::exchange(trajectory.energy, energy);
    }
    const auto count = static_cast<double>(trajectories().size());
    constexpr double kDeviations = 3;
    return std::fabs(change) <=
               kDeviations * std::sqrt(2 * experiment_.VarianceOfEnergy() * count) ||
           group_.stretches >= kLongestWarmUp * WarmUp();
  }

  void EndStretch() {
    ++stretches_;
    ++group_.stretches;
    if (!is_measuring_) return;
    // A ball has one contact on its left and one on its right.
    const auto sections = 2 * static_cast<double>(experiment_.geometry().shape().columns);
    std::vector<double> charges;
    for (size_t i = 0; i < carried_.size(); ++i) {
      const double carried = run_->meters()[i].carried();
      charges.push_back((carried - std::exchange(carried_[i], carried)) / sections);
    }
    group_.AddStretch(charges);
  }

  BlockResult Result() {
    BlockResult result = experiment_.EmptyResult();
    result.samples = block_->samples;
    for (size_t i = 0; i < trajectories().size(); ++i) {
      SteadyTrajectory& trajectory = trajectories()[i];
      GasMeter& meter = run_->meters()[i];
      trajectory.state = run_->StateOf(i);
      result.health.escapes += meter.escapes();
      if (!is_measuring_) continue;
      meter.End(Now());
      const std::vector<double> integrals = experiment_.IntegralsOf(meter);
      for (size_t j = 0; j < integrals.size(); ++j) trajectory.sums[j] += integrals[j];
    }
    run_.reset();
    result.groups[block_->chunk % result.groups.size()] =
        experiment_.shape().Written(std::exchange(group_, {}));
    return result;
  }

  const SteadyGas& experiment_;
  BlockQueue& queue_;
  std::optional<Block> block_;
  SteadyGroup group_;
  std::unique_ptr<GasRun> run_;  // of the chunk; null before it has started
  double stretches_ = 0;         // of this chunk
  bool is_measuring_ = false;
  std::vector<double> carried_;  // by each trajectory, at the last end of a stretch
};

// A ball anywhere in its cell, or beyond a wall by rounding.
bool IsPossible(const GasBall& ball, const GasGeometry& geometry) {
  constexpr double kRounding = 1e-9;
  const Eigen::Vector2d to_a_corner = Eigen::Vector2d(0.5, 0.5) - ball.position.cwiseAbs();
  return to_a_corner.minCoeff() >= -kRounding &&
         to_a_corner.norm() >= geometry.pair().rho() - kRounding;
}

bool IsPossible(const SteadyTrajectory& trajectory, const GasGeometry& geometry) {
  return std::ranges::all_of(trajectory.state.balls,
                             [&](const GasBall& ball) { return IsPossible(ball, geometry); }) &&
         std::ranges::all_of(trajectory.state.pistons, [&](const GasPiston& piston) {
           return std::fabs(piston.offset) <= geometry.reach();
         });
}

bool IsCount(double number) {
  return number >= 0 && number <= static_cast<double>(kMaxSamples) && number == std::floor(number);
}

}  // namespace

SteadyGas::SteadyGas(const EnsembleSpec& spec, const PointParameters& point, double stretch,
                     size_t quantities)
    : GasExperiment(spec, point, OpenGasOf(point), MeanTemperature(point)),
      hot_(point[kHot] / temperature()),
      cold_(point[kCold] / temperature()),
      stretch_(WithoutLastBits(stretch)),
      trajectories_(ForecastOf(spec, point).trajectories.value()),
      shape_({.trajectories = trajectories_.each,
              .quantities = quantities,
              .balls = static_cast<size_t>(geometry().balls()),
              .pistons = static_cast<size_t>(geometry().pistons()),
              .has_positions = answer().model != Model::kMarkov}) {}

TemperatureProfile SteadyGas::TemperaturesAtStart() const {
  return {hot_, cold_, static_cast<double>(geometry().shape().columns)};
}

// A ball has two degrees of freedom at its temperature T, a piston one: the variance of a kinetic
// energy is T^2/2 for each. The pistons between rows are in the columns of the balls.
double SteadyGas::VarianceOfEnergy() const {
  const TemperatureProfile temperature = TemperaturesAtStart();
  const GasShape& shape = geometry().shape();
  const double in_a_column = shape.is_lattice ? 1.5 : 1;
  double of_a_row = 0;
  for (int64_t column = 0; column <= shape.columns; ++column) {
    const auto x = static_cast<double>(column);
    of_a_row += std::pow(temperature.At(x), 2) / 2;
    if (column < shape.columns) of_a_row += in_a_column * std::pow(temperature.At(x + 0.5), 2);
  }
  return static_cast<double>(shape.rows) * of_a_row;
}

std::unique_ptr<EngineRun> SteadyGas::StartRun(BlockQueue& queue) const {
  return std::make_unique<GroupRun>(*this, queue);
}

bool SteadyGas::CanContinue(const GroupState& state) const {
  const std::span<const double> numbers = state.numbers();
  if (numbers.size() != shape_.Numbers()) return false;
  if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); })) {
    return false;
  }
  const SteadyGroup group = shape_.Read(state);
  return IsCount(group.stretches) && IsCount(group.measured) && group.measured <= group.stretches &&
         std::ranges::all_of(group.trajectories, [&](const SteadyTrajectory& trajectory) {
           return !shape_.has_positions || IsPossible(trajectory, geometry());
         });
}

std::vector<SteadyGroup> SteadyGas::GroupsOf(const BlockResult& merged) const {
  std::vector<SteadyGroup> groups;
  for (const GroupState& state : merged.groups) {
    if (state.empty()) continue;
    SteadyGroup group = shape_.Read(state);
    if (group.measured > 0) groups.push_back(std::move(group));
  }
  return groups;
}

uint64_t SteadyGas::StretchesOf(const std::vector<SteadyGroup>& groups) const {
  uint64_t stretches = 0;
  for (const SteadyGroup& group : groups) {
    stretches += trajectories_.each * static_cast<uint64_t>(group.measured);
  }
  return stretches;
}

// Trajectories are independent, and each has many events. But the measured groups are those whose
// energy has changed little, so they scatter less than all would if many are missing.
Estimate SteadyGas::TimeAverage(size_t quantity, double share,
                                const std::vector<SteadyGroup>& groups) const {
  BatchMeans means;
  for (const SteadyGroup& group : groups) {
    for (const SteadyTrajectory& trajectory : group.trajectories) {
      means.Add(trajectory.sums[quantity], share * group.measured * stretch_);
    }
  }
  Estimate average = RatioOf(means, kEventsForAnError);
  if (8 * groups.size() < 7 * trajectories_.groups) average.standard_error.reset();
  return average;
}

std::string SteadyGas::ReasonOfNoError(absl::string_view estimate) const {
  return absl::StrCat(estimate,
                      " has no standard error: fewer than seven eighths of the trajectories have "
                      "been measured; a trajectory is measured after its warm-up");
}

// A chunk begins where the longest warm-up ends; the chunk has samples if one more is asked for.
std::string SteadyGas::RemarkOnUnmeasured(const std::vector<SteadyGroup>& groups) const {
  const double enough = kLongestWarmUp * static_cast<double>(plan().warm_up()) + 1;
  const uint64_t unmeasured = trajectories_.groups - groups.size();
  if (unmeasured == 0) return "";
  const std::string advice =
      absl::StrFormat("ask for more samples (with %.0f all are measured in any case)", enough);
  if (groups.empty()) {
    return "all trajectories are still warming up, so nothing has been measured yet; " + advice;
  }
  return absl::StrFormat(
      "%d of %d groups of trajectories are still warming up; the others may not be typical; %s",
      unmeasured, trajectories_.groups, advice);
}

std::string SteadyGas::RemarkOnWarmUp(const std::vector<SteadyGroup>& groups) {
  constexpr double kDeviations = 4;
  Moments changes;
  double energy = 0;
  for (const SteadyGroup& group : groups) {
    for (const SteadyTrajectory& trajectory : group.trajectories) {
      const double now = EnergyOf(trajectory.state);
      changes.Add(now - trajectory.energy);
      energy += now;
    }
  }
  if (changes.count < 2) return "";
  if (std::fabs(changes.mean) <= kDeviations * *changes.StandardError()) return "";
  return absl::StrFormat(
      "the energy of the gas has changed by %.2g %% since its warm-up ended, so the state may not "
      "be stationary",
      100 * changes.mean * static_cast<double>(changes.count) / energy);
}

}  // namespace ballpiston
