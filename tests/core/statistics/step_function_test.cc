#include "core/statistics/step_function.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The jumps of the functions lie on a grid of this step. So the trapezoidal rule is exact for
// integrands that are linear between the grid's points.
constexpr double kStep = 1.0 / 16;

struct OnGrid {
  StepFunction function;
  std::vector<double> values;  // by cell of the grid
};

// `pieces` of lengths 0 to 11 steps; then the last value for `rest` steps more.
OnGrid RandomOnGrid(CounterRandom& random, int pieces, size_t rest) {
  double now = random.Uniform();
  OnGrid made = {StepFunction(now), {}};
  for (int i = 0; i < pieces; ++i) {
    const size_t steps = random.Bits() % 12;
    made.values.insert(made.values.end(), steps, now);
    now = random.Uniform();
    made.function.Add(static_cast<double>(steps) * kStep, now);
  }
  made.values.insert(made.values.end(), rest, now);
  return made;
}

double IntegralByCells(const OnGrid& of, double mean, size_t from, size_t to) {
  double sum = 0;
  for (size_t i = from; i < to; ++i) sum += (of.values[i] - mean) * kStep;
  return sum;
}

double CorrelationByCells(const OnGrid& of, double mean, size_t origins, size_t window) {
  double sum = 0;
  for (size_t i = 0; i < origins; ++i) {
    const double at_begin = IntegralByCells(of, mean, i, i + window);
    const double at_end = IntegralByCells(of, mean, i + 1, i + 1 + window);
    sum += (of.values[i] - mean) * kStep * (at_begin + at_end) / 2;
  }
  return sum / (static_cast<double>(origins) * kStep);
}

// Windows and origins shorter than a piece, longer than the whole record, and in between. Some
// 1e4 terms of order 1: rounding stays below 1e-12.
TEST(StepFunction, IntegralIsExact) {
  constexpr size_t kRest = 2000;
  CounterRandom random(11, 0, 0);
  for (const int pieces : {0, 1, 2, 5, 40, 200}) {
    for (const size_t origins : {1u, 3u, 50u, 900u}) {
      for (const size_t window : {0u, 1u, 2u, 30u, 1000u}) {
        const OnGrid of = RandomOnGrid(random, pieces, kRest);
        const double mean = 0.3, span = static_cast<double>(origins) * kStep,
                     length = static_cast<double>(window) * kStep;
        EXPECT_NEAR(of.function.CorrelationIntegral(mean, span, length),
                    CorrelationByCells(of, mean, origins, window), 1e-12)
            << pieces << " pieces, " << origins << " origins, window " << window;
        EXPECT_NEAR(of.function.Integral(mean, length), IntegralByCells(of, mean, 0, window),
                    1e-12);
      }
    }
  }
}

// Jumps anywhere, on samples and by an ulp beside them.
TEST(StepFunction, SamplesAreTheValuesAtTheirTimes) {
  CounterRandom random(1, 2, 3);
  for (int trial = 0; trial < 300; ++trial) {
    const double step = random.Uniform();
    StepFunction function(0);
    std::vector<double> jumps = {0};
    for (int draw = 0; draw < 200; ++draw) {
      const double sample = step * std::floor(80 * random.Uniform());
      const double times[] = {sample, std::nextafter(sample, 0), std::nextafter(sample, 99),
                              80 * step * random.Uniform()};
      const double time = times[random.Bits() % 4];
      if (time <= jumps.back()) continue;
      function.Add(time - jumps.back(), static_cast<double>(jumps.size()));
      jumps.push_back(function.last_jump());
    }
    EXPECT_EQ(function.jumps(), jumps.size() - 1);
    const std::vector<double> samples = function.Samples(step, 60);
    ASSERT_EQ(samples.size(), 60u);
    for (size_t i = 0; i < samples.size(); ++i) {
      const auto later =
          std::upper_bound(jumps.begin(), jumps.end(), step * static_cast<double>(i));
      ASSERT_EQ(samples[i], static_cast<double>(later - jumps.begin() - 1));
    }
  }
}

}  // namespace
}  // namespace ballpiston
