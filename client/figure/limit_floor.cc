#include "client/figure/limit_floor.h"

#include <algorithm>
#include <cmath>

namespace ballpiston::client {
namespace {

// Its longest run's scatter is known best.
std::optional<double> CrossingWork(const std::vector<MethodMeasurement>& measurements,
                                   const LimitFloor& floor) {
  std::optional<double> work;
  for (const MethodMeasurement& m : measurements) {
    if (m.quantity != kRelaxationTime || m.method != kBilliard || m.delta != floor.delta ||
        m.samples < kFewestOrbits) {
      continue;
    }
    const double ratio = OwnError(m, floor) / floor.Height();
    work = m.work * ratio * ratio;
  }
  return work;
}

}  // namespace

double OwnError(const MethodMeasurement& run, const LimitFloor& floor) {
  const double error = run.statistical_error;
  return std::sqrt(std::max(error * error - floor.error * floor.error, 0.0));
}

std::vector<LimitFloor> FloorsOf(const std::vector<MethodMeasurement>& measurements) {
  std::vector<LimitFloor> floors;
  for (const MethodMeasurement& m : measurements) {
    if (m.quantity != kRelaxationTime || m.method != kSpectrum) {
      continue;
    }
    floors.push_back(
        {.delta = m.delta, .bias = m.value, .error = m.statistical_error, .work = m.work});
    floors.back().crossing_work = CrossingWork(measurements, floors.back());
  }
  std::stable_sort(floors.begin(), floors.end(),
                   [](const LimitFloor& a, const LimitFloor& b) { return a.delta > b.delta; });
  const auto same = [](const LimitFloor& a, const LimitFloor& b) { return a.delta == b.delta; };
  floors.erase(std::unique(floors.begin(), floors.end(), same), floors.end());
  return floors;
}

}  // namespace ballpiston::client
