// A function of time that is constant between jumps, and its correlation integrals.
//
// The function starts at time 0; the last value holds for ever. Averages over time origins need the
// function up to origins + the longest lag. Properties, each with a test of its name:
//   1. IntegralIsExact: of the product with a later window, piece by piece, without a time step.
//   2. SamplesAreTheValuesAtTheirTimes.
// Not thread-safe while Add is called.
#pragma once

#include <cstddef>
#include <vector>

namespace ballpiston {

class StepFunction {
 public:
  explicit StepFunction(double first);

  // Adds a jump to `value`, at `duration` >= 0 after the last jump.
  void Add(double duration, double value);

  double last_jump() const { return times_.back(); }
  size_t jumps() const { return times_.size() - 1; }

  // The values at 0, step, 2 step, ...; step > 0.
  std::vector<double> Samples(double step, size_t count) const;

  // int_0^end (x(t) - mean) dt.
  double Integral(double mean, double end) const;

  // The correlation integral over a finite window:
  // 1/origins int_0^origins dt (x(t) - mean) int_t^(t + window) dt' (x(t') - mean).
  double CorrelationIntegral(double mean, double origins, double window) const;

 private:
  // The end of piece `i`; infinity for the last piece.
  double End(size_t i) const;

  std::vector<double> times_;  // at which the pieces begin, ascending
  std::vector<double> values_;
};

}  // namespace ballpiston
