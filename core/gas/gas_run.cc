#include "core/gas/gas_run.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "core/gas/jump_gas.h"
#include "core/gas/lane_gas.h"
#include "core/gas/reference_gas.h"

namespace ballpiston {
namespace {

// Nanoseconds.
constexpr double kOfAnEvent = 300;
constexpr double kToAllocateABody = 20;

void Record(ReferenceGas& gas, GasMeter& meter) {
  const GasEvent event = gas.Step();
  if (event.kind == EventKind::kBallPiston) {
    meter.Exchange({event.time, event.ball, event.piston, event.direction,
                    gas.BallEnergy(event.ball), gas.PistonEnergy(event.piston)});
  } else if (event.kind == EventKind::kPistonWall) {
    meter.SetPiston(event.time, event.piston, gas.PistonEnergy(event.piston));
  } else if (event.kind == EventKind::kEscape) {
    meter.CountEscape();
  }
}

bool Advance(ReferenceGas& gas, double time, GasMeter& meter, Pauses& pauses) {
  while (gas.NextTime() <= time) {
    Record(gas, meter);
    if (pauses.After(kOfAnEvent)) return false;
  }
  return true;
}

GasState StateOf(const ReferenceGas& gas, double time) { return gas.StateAt(time); }
GasState StateOf(const JumpGas& gas, double) { return gas.State(); }

bool Advance(JumpGas& gas, double time, GasMeter& meter, Pauses& pauses) {
  return gas.AdvanceTo(time, meter, pauses);
}

// Gases that run one after the other.
template <typename Gas>
class SeparateGases : public GasRun {
 public:
  // `make` makes a gas that has not begun.
  SeparateGases(const GasGeometry& geometry, std::vector<GasStart> replicas,
                std::function<Gas(GasStart&)> make)
      : bodies_(static_cast<double>(geometry.balls() + geometry.pistons())),
        starts_(std::move(replicas)),
        make_(std::move(make)) {
    gases_.reserve(starts_.size());
  }

  bool AdvanceTo(double time, Pauses& pauses) override {
    if (!Begin(pauses)) return false;
    for (size_t i = 0; i < gases_.size(); ++i) {
      if (!Advance(gases_[i], time, *starts_[i].meter, pauses)) return false;
    }
    time_ = time;
    return true;
  }

  GasState StateOf(size_t replica) const override {
    return ballpiston::StateOf(gases_[replica], time_);
  }

 private:
  bool Begin(Pauses& pauses) {
    for (; begun_ < starts_.size(); ++begun_) {
      GasStart& start = starts_[begun_];
      if (gases_.size() == begun_) {
        gases_.push_back(make_(start));
        if (pauses.After(kToAllocateABody * bodies_)) return false;
      }
      if (!gases_.back().Begin(start.state, pauses)) return false;
      start.state = {};
    }
    return true;
  }

  double bodies_;
  std::vector<GasStart> starts_;
  std::function<Gas(GasStart&)> make_;
  size_t begun_ = 0;  // gases that are complete
  double time_ = 0;
  std::vector<Gas> gases_;
};

// In the jump process the outermost pistons have their mean energy from the start.
void SetOutermost(const GasGeometry& geometry, const GasStart& start) {
  for (int64_t piston = 0; piston < geometry.pistons(); ++piston) {
    if (!start.walls.Has(piston)) continue;
    start.meter->SetPiston(0, piston, start.walls.TemperatureAt(piston) / 2);
  }
}

}  // namespace

std::unique_ptr<GasRun> StartGases(GasEngine engine, const GasGeometry& geometry,
                                   double exchange_rate, std::vector<GasStart> replicas) {
  switch (engine) {
    case GasEngine::kJumps:
      return std::make_unique<SeparateGases<JumpGas>>(
          geometry, std::move(replicas),
          [geometry, density = std::sqrt(std::numbers::pi) * exchange_rate](GasStart& start) {
            SetOutermost(geometry, start);
            return JumpGas(geometry, density, std::move(start.walls), start.random.OfJumps());
          });
    case GasEngine::kLanes:
      return std::make_unique<LaneGas>(geometry, exchange_rate, std::move(replicas));
    case GasEngine::kReference:
      break;
  }
  return std::make_unique<SeparateGases<ReferenceGas>>(
      geometry, std::move(replicas),
      [geometry](GasStart& start) { return ReferenceGas(geometry, std::move(start.walls)); });
}

}  // namespace ballpiston
