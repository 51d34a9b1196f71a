// Specifications of one point.
#ifndef BALLPISTON_TESTS_CORE_ONE_POINT_SPEC_H_
#define BALLPISTON_TESTS_CORE_ONE_POINT_SPEC_H_

#include <cstdint>
#include <optional>

#include "core/experiment/ensemble_spec.h"
#include "core/geometry/paper.h"

namespace ballpiston {

inline PointParameters PaperPoint(double delta, std::optional<double> epsilon = {},
                                  std::optional<double> exponent = {}) {
  return {.rho = kPaperRho, .delta = delta, .epsilon = epsilon, .exponent = exponent};
}

inline EnsembleSpec SpecOf(Experiment experiment, const PointParameters& point,
                           const Target& target = {}, Model model = Model::kAuto,
                           uint64_t seed = 0) {
  EnsembleSpec spec = {.experiment = experiment,
                       .grid = {.rho = {point.rho}, .delta = {point.delta}},
                       .target = target,
                       .seed = seed,
                       .model = model};
  if (point.epsilon) spec.grid.epsilon = {*point.epsilon};
  if (point.exponent) spec.grid.exponent = {*point.exponent};
  return spec;
}

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_ONE_POINT_SPEC_H_
