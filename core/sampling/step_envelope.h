// Draws from a density by rejection: a proposal is uniform under steps of equal widths that lie
// above the density. For a smooth density almost every proposal is accepted.
//
// Uses only +, -, * and /, so the bits are the same on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/sampling/counter_random.h"

namespace ballpiston {

class StepEnvelope {
 public:
  // bound(a, b) is an upper bound of the density between a and b. At least one is positive.
  template <typename Bound>
  StepEnvelope(double from, double to, const Bound& bound)
      : from_(from), width_((to - from) / kSteps) {
    for (size_t i = 0; i < kSteps; ++i) {
      steps_[i] = {.height = bound(LeftOf(i), LeftOf(i + 1)), .before = area_};
      area_ += steps_[i].height * width_;
    }
    for (size_t i = 0, step = 0; i < kSteps; ++i) {
      step = StepAt(static_cast<double>(i) / kSteps * area_, step);
      guide_[i] = static_cast<uint16_t>(step);
    }
  }

  // Calls density(x) for each proposal, and returns the x that is accepted.
  template <typename Density>
  double Draw(CounterRandom& random, const Density& density) const {
    for (;;) {
      const double place = random.Uniform();
      const double area = place * area_;
      const size_t i = StepAt(area, guide_[static_cast<size_t>(place * kSteps)]);
      const double x = LeftOf(i) + (area - steps_[i].before) / steps_[i].height;
      if (random.Uniform() * steps_[i].height < density(x)) return x;
    }
  }

 private:
  static constexpr size_t kSteps = 256;

  struct Step {
    double height = 0;
    double before = 0;  // the area of the steps on its left
  };

  double LeftOf(size_t step) const { return from_ + static_cast<double>(step) * width_; }

  // The step that contains this area; the search begins at `step`, which is not beyond it.
  size_t StepAt(double area, size_t step) const {
    while (step + 1 < kSteps && steps_[step + 1].before <= area) ++step;
    return step;
  }

  double from_;
  double width_;
  double area_ = 0;
  std::array<Step, kSteps> steps_;
  std::array<uint16_t, kSteps> guide_;  // for places from i/kSteps on: where the search begins
};

}  // namespace ballpiston
