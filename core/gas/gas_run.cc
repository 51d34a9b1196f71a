#include "core/gas/gas_run.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/gas/jump_gas.h"
#include "core/gas/lane_gas.h"
#include "core/gas/reference_gas.h"

namespace ballpiston {
namespace {

constexpr int kEventsOfACall = 6000;  // of 300 ns

bool AdvanceToward(double time, ReferenceGas& gas, GasMeter& meter) {
  for (int i = 0; i < kEventsOfACall; ++i) {
    if (gas.NextTime() > time) return true;
    meter.See(gas.Step());
  }
  return false;
}

GasState StateOf(const ReferenceGas& gas, double time) { return gas.StateAt(time); }
GasState StateOf(const JumpGas& gas, double) { return gas.State(); }

bool AdvanceToward(double time, JumpGas& gas, GasMeter& meter) {
  return gas.AdvanceToward(time, meter);
}

// Gases that run one after the other. A call moves only one of them, so it takes no longer with
// many.
template <typename Gas>
class SeparateGases : public GasRun {
 public:
  // make(start, meter) returns a gas, and prepares its meter.
  template <typename Make>
  SeparateGases(const GasGeometry& geometry, std::vector<GasStart> replicas, const Make& make)
      : GasRun(geometry, replicas) {
    gases_.reserve(replicas.size());
    for (size_t i = 0; i < replicas.size(); ++i) gases_.push_back(make(replicas[i], meters()[i]));
  }

  bool AdvanceToward(double time) override {
    if (time > time_) {
      time_ = time;
      arrived_ = 0;
    }
    if (arrived_ < gases_.size() &&
        ballpiston::AdvanceToward(time, gases_[arrived_], meters()[arrived_])) {
      ++arrived_;
    }
    return arrived_ == gases_.size();
  }

  GasState StateOf(size_t replica) const override {
    return ballpiston::StateOf(gases_[replica], time_);
  }

 private:
  std::vector<Gas> gases_;
  double time_ = 0;
  size_t arrived_ = 0;  // gases that are at time_
};

// In the jump process the outermost pistons have their mean energy from the start.
void SetOutermost(const GasGeometry& geometry, const ThermalWalls& walls, GasMeter& meter) {
  for (int64_t piston = 0; piston < geometry.pistons(); ++piston) {
    if (walls.Has(piston)) meter.SetPiston(0, piston, walls.TemperatureAt(piston) / 2);
  }
}

}  // namespace

std::unique_ptr<GasRun> StartGases(GasEngine engine, const GasGeometry& geometry,
                                   double exchange_rate, std::vector<GasStart> replicas) {
  switch (engine) {
    case GasEngine::kJumps:
      return std::make_unique<SeparateGases<JumpGas>>(
          geometry, std::move(replicas), [&](GasStart& start, GasMeter& meter) {
            SetOutermost(geometry, start.walls, meter);
            return JumpGas(geometry, std::sqrt(std::numbers::pi) * exchange_rate, start.state,
                           std::move(start.walls), start.random.OfJumps());
          });
    case GasEngine::kLanes:
      return std::make_unique<LaneGas>(geometry, exchange_rate, std::move(replicas));
    case GasEngine::kReference:
      break;
  }
  return std::make_unique<SeparateGases<ReferenceGas>>(
      geometry, std::move(replicas), [&](GasStart& start, GasMeter&) {
        return ReferenceGas(geometry, start.state, std::move(start.walls));
      });
}

}  // namespace ballpiston
