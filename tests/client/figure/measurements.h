// Measurements of a comparison of methods, as the program would print them.
#ifndef BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_
#define BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_

#include <cstdint>

#include "client/figure/method_measurement.h"

namespace ballpiston::client {

inline MethodMeasurement Measured(const char* method, const char* quantity, uint64_t samples,
                                  double work, double value, double error) {
  return {.method = method,
          .quantity = quantity,
          .samples = samples,
          .wall_hits = 100 * samples,
          .work = work,
          .value = value,
          .statistical_error = error};
}

inline MethodMeasurement RelaxationTime(const char* method, double delta, uint64_t samples,
                                        double work, double value, double error) {
  return {.method = method,
          .quantity = kRelaxationTime,
          .delta = delta,
          .samples = samples,
          .work = work,
          .value = value,
          .statistical_error = error};
}

}  // namespace ballpiston::client

#endif  // BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_
