// Random choices for tests: SplitMix64, the same numbers on every machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ballpiston {

class Dice {
 public:
  explicit Dice(uint64_t seed) : state_(seed) {}

  uint64_t Bits() {
    uint64_t x = state_ += 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
  }
  size_t Below(size_t end) { return static_cast<size_t>(Bits() % end); }  // end > 0
  bool OneIn(size_t n) { return Below(n) == 0; }
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }  // from [0, 1)
  bool Chance(double probability) { return Uniform() < probability; }

 private:
  uint64_t state_;
};

}  // namespace ballpiston
