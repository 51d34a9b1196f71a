// For the generator of questions: random choices, the same on every machine, and defects.
#pragma once

#include "core/ensemble/experiment_kind.h"
#include "core/sampling/counter_random.h"
#include "tests/questions/question.h"

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

// The neighbours of x among the doubles.
inline double Above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
inline double Below(double x) {
  return std::nextafter(x, -std::numeric_limits<double>::infinity());
}

// Changes a permitted question into one that the service has to refuse. `bound`: that of delta.
void AddDefect(Dice& dice, const ExperimentKind& experiment, double bound, Question& question);

}  // namespace ballpiston::questions
