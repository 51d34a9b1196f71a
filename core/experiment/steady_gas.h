// The base of experiments with a gas between reservoirs whose samples continue each other: a sample
// is a stretch of a trajectory (ensemble/chunk_plan.h). A chunk has its own clock and its own
// random numbers, so neither loses digits in a long run.
//
// Warm-up. A trajectory starts near local equilibrium and is not measured for some stretches. Then
// its group is judged: is the change of the gas's energy, the mean over the group's trajectories,
// within three standard deviations of 0? That change is the energy that has entered at one end,
// less that which has left at the other; its variance is at most twice that of the energy in local
// equilibrium. If not, the group warms up for one more chunk, and is judged again over that chunk.
// It is measured in any case after kLongestWarmUp times the warm-up. The decision depends on the
// specification and on the group alone.
//
// Errors are those of the scatter between all trajectories.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/experiment/gas_experiment.h"
#include "core/experiment/steady_group.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_meter.h"
#include "core/gas/thermal_walls.h"

namespace ballpiston {

inline constexpr double kLongestWarmUp = 16;

// The mean temperature of the two reservoirs.
inline double MeanTemperature(const PointParameters& point) {
  return (point[kHot] + point[kCold]) / 2;
}

class SteadyGas : public GasExperiment {
 public:
  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;
  bool CanContinue(const GroupState& state) const override;

  // A run of groups calls these functions, from any thread.
  const SteadyShape& shape() const { return shape_; }
  double stretch() const { return stretch_; }  // a time at temperature 1
  const Trajectories& trajectories() const { return trajectories_; }
  TemperatureProfile TemperaturesAtStart() const;
  // The variance of the gas's energy in local equilibrium. The time to compute it grows with the
  // number of columns.
  double VarianceOfEnergy() const;
  ThermalWalls WallsOf(const GasRandom& random) const { return {geometry(), hot_, cold_, random}; }
  // The integral over the meter's window, of each quantity.
  virtual std::vector<double> IntegralsOf(const GasMeter& meter) const = 0;

 protected:
  std::string ReasonOfNoError(absl::string_view estimate) const override;

  // Rounds the stretch (WithoutLastBits), because its last bits depend on the C library.
  SteadyGas(const EnsembleSpec& spec, const PointParameters& point, double stretch,
            size_t quantities);

  // The reservoirs' temperatures in units of their mean.
  double hot() const { return hot_; }
  double cold() const { return cold_; }

  // The groups that have been measured.
  std::vector<SteadyGroup> GroupsOf(const BlockResult& merged) const;
  // A quantity over time and over `share`. The error is that between the trajectories; there is
  // none if more than an eighth of the groups are missing.
  Estimate TimeAverage(size_t quantity, double share, const std::vector<SteadyGroup>& groups) const;
  // The number of stretches that all trajectories have measured. Those of the warm-up do not count.
  uint64_t StretchesOf(const std::vector<SteadyGroup>& groups) const;

  // A sentence if groups are still warming up; else empty.
  std::string RemarkOnUnmeasured(const std::vector<SteadyGroup>& groups) const;
  // A sentence if the gas's energy has changed during the measurement by more than its trajectories
  // scatter, or if its warm-up has not ended; else empty.
  static std::string RemarkOnWarmUp(const std::vector<SteadyGroup>& groups);

 private:
  double hot_;
  double cold_;
  double stretch_;
  Trajectories trajectories_;
  SteadyShape shape_;
};

}  // namespace ballpiston
