// Gases side by side in one engine, each with its meter.
#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"

namespace ballpiston {

class MeteredGases {
 public:
  // The meters of the starts may be null.
  MeteredGases(GasEngine engine, const GasGeometry& geometry, std::vector<GasStart> starts) {
    for (GasStart& start : starts) start.meter = &meters_.emplace_back(geometry, start.state);
    run_ = StartGases(engine, geometry, GasExchangeRate(geometry, 1), std::move(starts));
  }

  void AdvanceTo(double time) { run_->AdvanceTo(time); }
  bool AdvanceToward(double time) { return run_->AdvanceToward(time); }

  // In the order of the starts.
  std::deque<GasMeter>& meters() { return meters_; }

 private:
  std::deque<GasMeter> meters_;
  std::unique_ptr<GasRun> run_;
};

}  // namespace ballpiston
