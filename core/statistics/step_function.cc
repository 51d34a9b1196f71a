#include "core/statistics/step_function.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ballpiston {

StepFunction::StepFunction(double first) {
  constexpr size_t kUsualJumps = 64;
  times_.reserve(kUsualJumps);
  values_.reserve(kUsualJumps);
  times_.push_back(0);
  values_.push_back(first);
}

void StepFunction::Add(double duration, double value) {
  times_.push_back(times_.back() + duration);
  values_.push_back(value);
}

double StepFunction::End(size_t i) const {
  return i + 1 < times_.size() ? times_[i + 1] : std::numeric_limits<double>::infinity();
}

namespace {

// The first sample at or after a time, or one beyond `count`.
size_t FirstSampleFrom(double time, double step, size_t count) {
  double sample = std::min(std::ceil(time / step), static_cast<double>(count) + 1);
  if (sample >= 1 && step * (sample - 1) >= time) --sample;  // the quotient was rounded
  if (step * sample < time) ++sample;
  return static_cast<size_t>(sample);
}

}  // namespace

// Counts the jumps between two samples, then sums. This avoids a branch that depends on the times.
std::vector<double> StepFunction::Samples(double step, size_t count) const {
  std::vector<uint32_t> jumps(count + 1);
  for (size_t i = 1; i < times_.size(); ++i) {
    ++jumps[std::min(FirstSampleFrom(times_[i], step, count), count)];
  }
  std::vector<double> samples(count);
  size_t piece = 0;
  for (size_t i = 0; i < count; ++i) {
    piece += jumps[i];
    samples[i] = values_[piece];
  }
  return samples;
}

double StepFunction::Integral(double mean, double end) const {
  double sum = 0;
  for (size_t i = 0; i < times_.size() && times_[i] < end; ++i) {
    sum += (values_[i] - mean) * (std::min(End(i), end) - times_[i]);
  }
  return sum;
}

// The inner integral is a continuous function of t. It is linear between the times t at which an
// end of its window passes a jump.
double StepFunction::CorrelationIntegral(double mean, double origins, double window) const {
  size_t near = 0, far = 0;
  while (End(far) <= window) ++far;
  double inner = Integral(mean, window);
  double sum = 0;
  for (double t = 0; t < origins;) {
    const double next = std::min({origins, End(near), End(far) - window});
    const double length = std::max(next - t, 0.0);
    const double slope = values_[far] - values_[near];
    sum += (values_[near] - mean) * length * (inner + slope * length / 2);
    inner += slope * length;
    if (End(near) <= next) ++near;
    if (End(far) - window <= next) ++far;
    t = next;
  }
  return sum / origins;
}

}  // namespace ballpiston
