#include "tools/slow_pistons/idle_pistons.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/gas/canonical_gas.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"

namespace ballpiston::slow_pistons {
namespace {

ReferenceGas StartOf(const GasGeometry& geometry, const SteadyChain& chain) {
  const GasRandom random(chain.seed, 0, 0);
  CounterRandom of_start = random.OfStart();
  const TemperatureProfile temperatures(chain.hot, chain.cold,
                                        static_cast<double>(geometry.shape().columns));
  return {geometry, DrawGas(geometry, temperatures, of_start),
          ThermalWalls(geometry, chain.hot, chain.cold, random)};
}

class IdlePiston {
 public:
  explicit IdlePiston(double energy = -1, double since = 0) : energy_(energy), since_(since) {}

  // An exchange is an event after which the piston has another energy.
  void See(double time, double energy, bool is_with_ball, double crossing) {
    if (energy == energy_) return;
    const double idle = time - since_;
    for (size_t i = 0; i < kIdleTimes.size(); ++i) {
      idle_[i] += std::max(idle - kIdleTimes[i], 0.0);
      if (idle > kIdleTimes[i]) ++long_idles_[i];
      if (!is_with_ball && std::sqrt(2 * energy_) * kIdleTimes[i] < crossing) ++slow_arrivals_[i];
    }
    if (!is_with_ball) ++departures_;
    energy_ = energy;
    since_ = time;
  }

  // Adds a block of time, and begins the next one. `of_departure` is L'^2/(2 T), or 0 without a
  // wall.
  void EndBlock(double duration, double of_departure, IdleShares& shares) {
    for (size_t i = 0; i < kIdleTimes.size(); ++i) {
      const double s = kIdleTimes[i];
      shares[i].share.Add(s * idle_[i] / duration);
      shares[i].limit.Add((of_departure * departures_ + s * s * slow_arrivals_[i]) / duration);
      shares[i].long_idles += long_idles_[i];
      shares[i].slow_arrivals += slow_arrivals_[i];
    }
    *this = IdlePiston(energy_, since_);
  }

 private:
  double energy_;
  double since_;
  std::array<double, kIdleTimes.size()> idle_ = {};           // sums of (idle time - s)+
  std::array<double, kIdleTimes.size()> long_idles_ = {};     // number of them
  std::array<double, kIdleTimes.size()> slow_arrivals_ = {};  // at the wall, slower than L'/s
  double departures_ = 0;                                     // from the wall
};

void RunBlock(double end, double crossing, ReferenceGas& gas, std::vector<IdlePiston>& pistons) {
  while (gas.NextTime() < end) {
    const GasEvent event = gas.Step();
    if (event.piston < 0) continue;
    pistons[static_cast<size_t>(event.piston)].See(event.time, event.piston_energy, event.ball >= 0,
                                                   crossing);
  }
}

// L'^2/(2 T) of each piston, 0 of a piston between two balls.
std::vector<double> WeightsOfDepartures(const GasGeometry& geometry, const SteadyChain& chain,
                                        double crossing) {
  std::vector<double> weights(static_cast<size_t>(geometry.pistons()));
  weights.front() = crossing * crossing / (2 * chain.hot);
  weights.back() = crossing * crossing / (2 * chain.cold);
  return weights;
}

}  // namespace

std::vector<IdleShares> IdlePistons(const GasGeometry& geometry, const SteadyChain& chain) {
  const double crossing = geometry.pair().lambda() + geometry.pair().delta();
  const std::vector<double> weights = WeightsOfDepartures(geometry, chain, crossing);
  ReferenceGas gas = StartOf(geometry, chain);
  std::vector<IdlePiston> pistons(weights.size());
  std::vector<IdleShares> shares(weights.size()), warm_up(weights.size());
  for (uint64_t i = 0; i <= chain.blocks; ++i) {
    RunBlock(static_cast<double>(i + 1) * chain.block, crossing, gas, pistons);
    for (size_t k = 0; k < pistons.size(); ++k) {
      pistons[k].EndBlock(chain.block, weights[k], i == 0 ? warm_up[k] : shares[k]);
    }
  }
  return shares;
}

}  // namespace ballpiston::slow_pistons
