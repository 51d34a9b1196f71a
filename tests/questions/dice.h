// Random choices, the same on every machine.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sampling/counter_random.h"

namespace ballpiston::questions {

class Dice {
 public:
  Dice(uint64_t seed, uint64_t number) : random_(seed, 0, number) {}

  uint64_t Bits() { return random_.Bits(); }
  double Uniform() { return random_.Uniform(); }
  bool Chance(double probability) { return Uniform() < probability; }
  size_t Below(size_t n) { return static_cast<size_t>(Uniform() * static_cast<double>(n)); }
  double Between(double lower, double upper) { return lower + (upper - lower) * Uniform(); }
  double LogBetween(double lower, double upper) {
    return std::exp(Between(std::log(lower), std::log(upper)));
  }
  template <typename T>
  T Pick(const std::vector<T>& list) {
    return list[Below(list.size())];
  }

 private:
  CounterRandom random_;
};

}  // namespace ballpiston::questions
