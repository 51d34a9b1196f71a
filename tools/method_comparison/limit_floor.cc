#include "tools/method_comparison/limit_floor.h"

namespace ballpiston::method_comparison {

MethodMeasurement LimitFloorOf(const MethodMeasurement& spectrum,
                               const MethodMeasurement& billiard) {
  MethodMeasurement floor = spectrum;
  floor.quantity = Quantity::kLimitFloor;
  floor.own_error = floor.statistical_error;
  floor.bias_resolved = spectrum.value >= kFloorResolved * spectrum.statistical_error;
  if (!*floor.bias_resolved) floor.value += kFloorResolved * spectrum.statistical_error;
  floor.work = std::nullopt;
  if (billiard.samples >= kFewestFloorOrbits) {
    const double ratio = billiard.own_error / floor.value;
    floor.work = *billiard.work * ratio * ratio;
  }
  return floor;
}

}  // namespace ballpiston::method_comparison
