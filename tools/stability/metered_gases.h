// Gases side by side in one engine, each with its meter.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "tools/stability/gas_methods.h"

namespace ballpiston::stability {

class MeteredGases {
 public:
  MeteredGases(GasEngine engine, const GasGeometry& geometry,
               std::span<const GasReplica> replicas) {
    std::vector<GasStart> starts;
    for (const GasReplica& replica : replicas) {
      GasMeter& meter = meters_.emplace_back(geometry, replica.state);
      energies_.push_back(meter.TotalEnergy());
      starts.push_back({replica.state, replica.walls, replica.random, &meter});
    }
    run_ = StartGases(engine, geometry, GasExchangeRate(geometry, 1), std::move(starts));
  }

  void AdvanceTo(double time) { run_->AdvanceTo(time); }

  size_t size() const { return meters_.size(); }
  const GasMeter& meter(size_t replica) const { return meters_[replica]; }
  double EnergyAtStart(size_t replica) const { return energies_[replica]; }

 private:
  std::deque<GasMeter> meters_;
  std::vector<double> energies_;
  std::unique_ptr<GasRun> run_;
};

}  // namespace ballpiston::stability
