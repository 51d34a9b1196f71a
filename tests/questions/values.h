// Random choices, the same on every machine, and random values of the parameters and defects.
//
// Values lie in the permitted domain, or slightly or far outside of it. `extreme` values lie
// log-uniformly close to an end of the domain, or are the end itself or its neighbour among the
// doubles. The others are those of an ordinary question.
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

double Rho(Dice& dice, bool extreme);
double Delta(Dice& dice, double bound, bool extreme);
double Epsilon(Dice& dice, bool extreme);
double Exponent(Dice& dice, bool extreme);
std::string Cells(Dice& dice, bool extreme);
double Temperature(Dice& dice, bool extreme);
double Cold(Dice& dice, double hot, bool extreme);

double RhoOutside(Dice& dice);
double DeltaOutside(Dice& dice, double bound);
double EpsilonOutside(Dice& dice);
double ExponentOutside(Dice& dice);
std::string CellsOutside(Dice& dice);
double TemperatureOutside(Dice& dice);

// Changes a permitted question into one that the service has to refuse. `bound`: that of delta.
void AddDefect(Dice& dice, const ExperimentKind& experiment, double bound, Question& question);

}  // namespace ballpiston::questions
