// The reservoirs at the two ends of a gas: thermal walls, which the outermost pistons hit from
// inside. A piston leaves a thermal wall with a speed from the flux law at the wall's temperature.
// If both temperatures are equal, the gas is in equilibrium at this temperature.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_geometry.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// The random numbers of one replica of a gas. The start, the jumps and each wall have separate
// sequences.
class GasRandom {
 public:
  GasRandom(uint64_t seed, uint64_t stream, uint64_t replica)
      : seed_(seed), stream_(stream), replica_(replica) {}

  CounterRandom OfStart() const { return Sequence(0); }
  CounterRandom OfJumps() const { return Sequence(1); }
  CounterRandom OfWall(uint64_t wall) const { return Sequence(2 + wall); }

 private:
  CounterRandom Sequence(uint64_t user) const { return {seed_, stream_, replica_, user}; }

  uint64_t seed_;
  uint64_t stream_;
  uint64_t replica_;
};

class ThermalWalls {
 public:
  ThermalWalls() = default;  // no walls, for a periodic gas
  // The left one is hot, the right one cold: hot >= cold > 0.
  ThermalWalls(const GasGeometry& geometry, double hot, double cold, const GasRandom& random)
      : edges_(geometry.shape().columns + 1), hot_(hot), cold_(cold), random_(random) {
    if (geometry.ends() == GasEnds::kPeriodic) return;
    pistons_ = edges_ * geometry.shape().rows;
  }

  // Whether the piston has a thermal wall. Such a piston meets only one ball.
  bool Has(int64_t piston) const {
    return piston < pistons_ && (IsHot(piston) || piston % edges_ == edges_ - 1);
  }
  // Walls are numbered by row, the hot one first. The last four functions require Has.
  size_t Count() const { return static_cast<size_t>(2 * pistons_ / edges_); }
  int64_t PistonAt(size_t wall) const {
    const auto row = static_cast<int64_t>(wall / 2);
    return row * edges_ + (wall % 2 == 0 ? 0 : edges_ - 1);
  }
  size_t WallOf(int64_t piston) const {
    return static_cast<size_t>(2 * (piston / edges_) + (IsHot(piston) ? 0 : 1));
  }
  bool IsHot(int64_t piston) const { return piston % edges_ == 0; }
  double TemperatureAt(int64_t piston) const { return IsHot(piston) ? hot_ : cold_; }
  double DrawSpeed(int64_t piston) {
    if (sequences_.empty()) BeginSequences();
    return DrawFluxSpeed(TemperatureAt(piston), sequences_[WallOf(piston)]);
  }

 private:
  // At the first draw, because the jump process draws none. The sequences of two million walls take
  // 176 MB and a fifth of a second.
  void BeginSequences() {
    sequences_.reserve(Count());
    for (size_t wall = 0; wall < Count(); ++wall) sequences_.push_back(random_.OfWall(wall));
  }

  int64_t edges_ = 1;    // of a row
  int64_t pistons_ = 0;  // along x
  double hot_ = 0;
  double cold_ = 0;
  GasRandom random_ = {0, 0, 0};
  std::vector<CounterRandom> sequences_;  // of each wall
};

}  // namespace ballpiston
