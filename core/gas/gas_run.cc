#include "core/gas/gas_run.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/gas/jump_gas.h"
#include "core/gas/lane_gas.h"
#include "core/gas/reference_gas.h"

namespace ballpiston {
namespace {

class ReferenceRun : public GasRun {
 public:
  ReferenceRun(const GasGeometry& geometry, std::vector<GasStart> replicas) {
    for (GasStart& start : replicas) {
      replicas_.push_back(
          {ReferenceGas(geometry, start.state, std::move(start.walls)), start.meter});
    }
  }

  void AdvanceTo(double time) override {
    for (Replica& replica : replicas_) {
      while (replica.gas.NextTime() <= time) Record(replica);
    }
  }

 private:
  struct Replica {
    ReferenceGas gas;
    GasMeter* meter;
  };

  void Record(Replica& replica) {
    ReferenceGas& gas = replica.gas;
    const GasEvent event = gas.Step();
    if (event.kind == EventKind::kBallPiston) {
      replica.meter->Exchange({event.time, event.ball, event.piston, event.direction,
                               gas.BallEnergy(event.ball), gas.PistonEnergy(event.piston)});
    } else if (event.kind == EventKind::kPistonWall) {
      replica.meter->SetPiston(event.time, event.piston, gas.PistonEnergy(event.piston));
    } else if (event.kind == EventKind::kEscape) {
      replica.meter->CountEscape();
    }
  }

  std::vector<Replica> replicas_;
};

class JumpRun : public GasRun {
 public:
  JumpRun(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas) {
    const double density = std::sqrt(std::numbers::pi) * exchange_rate;
    for (GasStart& start : replicas) {
      SetOutermost(geometry, start);
      const CounterRandom random = start.random.OfJumps();
      replicas_.push_back(
          {JumpGas(geometry, density, start.state, std::move(start.walls), random), start.meter});
    }
  }

  void AdvanceTo(double time) override {
    for (Replica& replica : replicas_) replica.gas.AdvanceTo(time, *replica.meter);
  }

 private:
  struct Replica {
    JumpGas gas;
    GasMeter* meter;
  };

  // The outermost pistons have their mean energy from the start.
  static void SetOutermost(const GasGeometry& geometry, const GasStart& start) {
    for (int64_t piston = 0; piston < geometry.pistons(); ++piston) {
      if (!start.walls.Has(piston)) continue;
      start.meter->SetPiston(0, piston, start.walls.TemperatureAt(piston) / 2);
    }
  }

  std::vector<Replica> replicas_;
};

}  // namespace

std::unique_ptr<GasRun> StartGases(GasEngine engine, const GasGeometry& geometry,
                                   double exchange_rate, std::vector<GasStart> replicas) {
  switch (engine) {
    case GasEngine::kJumps:
      return std::make_unique<JumpRun>(geometry, exchange_rate, std::move(replicas));
    case GasEngine::kLanes:
      return std::make_unique<LaneGas>(geometry, exchange_rate, std::move(replicas));
    case GasEngine::kReference:
      break;
  }
  return std::make_unique<ReferenceRun>(geometry, std::move(replicas));
}

}  // namespace ballpiston
