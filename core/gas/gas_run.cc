#include "core/gas/gas_run.h"

#include <cmath>
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

double BodiesOf(const GasGeometry& geometry) {
  return static_cast<double>(geometry.balls() + geometry.pistons());
}

class ReferenceRun : public GasRun {
 public:
  ReferenceRun(const GasGeometry& geometry, std::vector<GasStart> replicas)
      : geometry_(geometry), starts_(std::move(replicas)) {
    gases_.reserve(starts_.size());
  }

  bool AdvanceTo(double time, Pauses& pauses) override {
    if (!Begin(pauses)) return false;
    for (size_t i = 0; i < gases_.size(); ++i) {
      while (gases_[i].NextTime() <= time) {
        Record(gases_[i], *starts_[i].meter);
        if (pauses.After(kOfAnEvent)) return false;
      }
    }
    return true;
  }

 private:
  bool Begin(Pauses& pauses) {
    for (; begun_ < starts_.size(); ++begun_) {
      GasStart& start = starts_[begun_];
      if (gases_.size() == begun_) {
        gases_.emplace_back(geometry_, std::move(start.walls));
        if (pauses.After(kToAllocateABody * BodiesOf(geometry_))) return false;
      }
      if (!gases_.back().Begin(start.state, pauses)) return false;
      start.state = {};
    }
    return true;
  }

  static void Record(ReferenceGas& gas, GasMeter& meter) {
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

  GasGeometry geometry_;
  std::vector<GasStart> starts_;
  size_t begun_ = 0;  // gases that are complete
  std::vector<ReferenceGas> gases_;
};

class JumpRun : public GasRun {
 public:
  JumpRun(const GasGeometry& geometry, double exchange_rate, std::vector<GasStart> replicas)
      : geometry_(geometry),
        density_(std::sqrt(std::numbers::pi) * exchange_rate),
        starts_(std::move(replicas)) {
    gases_.reserve(starts_.size());
  }

  bool AdvanceTo(double time, Pauses& pauses) override {
    if (!Begin(pauses)) return false;
    for (size_t i = 0; i < gases_.size(); ++i) {
      if (!gases_[i].AdvanceTo(time, *starts_[i].meter, pauses)) return false;
    }
    return true;
  }

 private:
  bool Begin(Pauses& pauses) {
    for (; begun_ < starts_.size(); ++begun_) {
      GasStart& start = starts_[begun_];
      if (gases_.size() == begun_) {
        SetOutermost(start);
        gases_.emplace_back(geometry_, density_, std::move(start.walls), start.random.OfJumps());
      }
      if (!gases_.back().Begin(start.state, pauses)) return false;
      start.state = {};
    }
    return true;
  }

  // The outermost pistons have their mean energy from the start.
  void SetOutermost(const GasStart& start) const {
    for (int64_t piston = 0; piston < geometry_.pistons(); ++piston) {
      if (!start.walls.Has(piston)) continue;
      start.meter->SetPiston(0, piston, start.walls.TemperatureAt(piston) / 2);
    }
  }

  GasGeometry geometry_;
  double density_;
  std::vector<GasStart> starts_;
  size_t begun_ = 0;  // gases that are complete
  std::vector<JumpGas> gases_;
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
