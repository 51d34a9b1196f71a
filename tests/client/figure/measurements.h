// Measurements of a comparison of methods, as a server would send them.
#ifndef BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_
#define BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_

#include <cstdint>

#include "ballpiston/v1/method.pb.h"

namespace ballpiston::client {

inline v1::MethodMeasurement Measured(v1::MethodMeasurement::Method method,
                                      v1::MethodMeasurement::Quantity quantity, uint64_t samples,
                                      double work, double value, double error) {
  v1::MethodMeasurement measurement;
  measurement.set_method(method);
  measurement.set_quantity(quantity);
  measurement.set_samples(samples);
  measurement.set_wall_hits(100 * samples);
  measurement.set_work(work);
  measurement.set_value(value);
  measurement.set_statistical_error(error);
  return measurement;
}

inline v1::MethodMeasurement RelaxationTime(v1::MethodMeasurement::Method method, double delta,
                                            uint64_t samples, double work, double value,
                                            double error) {
  v1::MethodMeasurement measurement =
      Measured(method, v1::MethodMeasurement::RELAXATION_TIME, samples, work, value, error);
  measurement.set_delta(delta);
  measurement.set_wall_hits(0);
  return measurement;
}

}  // namespace ballpiston::client

#endif  // BALLPISTON_TESTS_CLIENT_FIGURE_MEASUREMENTS_H_
