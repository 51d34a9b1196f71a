// Between the API's comparison of methods and the core's. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_METHOD_H_
#define BALLPISTON_SERVER_CONVERT_METHOD_H_

#include <vector>

#include "ballpiston/v1/method.pb.h"
#include "core/experiment/ensemble_spec.h"
#include "core/method_comparison/method_comparison.h"

namespace ballpiston::server {

inline constexpr double kDefaultSecondsPerCurve = 1;
// Those of them that are permitted at the request's rho.
inline constexpr double kDefaultRelaxationDeltas[] = {0.2, 0.1, 0.05, 0.025};

struct CheckedComparison {
  MethodComparisonSpec spec;  // can be run if there are no violations
  std::vector<FieldViolation> violations;
};

// What the message asks for and everything that is wrong with it.
CheckedComparison CheckComparison(const v1::CompareMethodsRequest& request);

v1::MethodMeasurement MeasurementMessage(const MethodMeasurement& measurement);

// One of the message's for each of the core's, and the other way round.
v1::MethodMeasurement::Method MethodMessage(Method method);
v1::MethodMeasurement::Quantity QuantityMessage(Quantity quantity);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_METHOD_H_
