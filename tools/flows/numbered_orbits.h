// A source of orbits that are numbered from 0.
#pragma once

#include <cstdint>
#include <optional>

#include "core/billiard/orbits.h"

namespace ballpiston {

class NumberedOrbits : public OrbitSource {
 public:
  virtual PairState Start(uint64_t orbit) = 0;

  // Runs orbits 0 ... count - 1 to their ends. Returns false if Pause stopped the run before
  // that.
  bool Run(Engine engine, const PairGeometry& geometry, uint64_t count) {
    next_ = 0;
    count_ = count;
    return StartOrbits(engine, geometry, *this)->Advance();
  }

  std::optional<OrbitStart> Next() override {
    if (next_ == count_) return std::nullopt;
    const uint64_t orbit = next_++;
    return OrbitStart{orbit, Start(orbit)};
  }
  bool Pause() override { return false; }

 private:
  uint64_t next_ = 0;
  uint64_t count_ = 0;
};

}  // namespace ballpiston
