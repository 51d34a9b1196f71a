// Specifications of one point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/ensemble/ensemble_spec.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "tools/flows/paper.h"

namespace ballpiston {

inline PointParameters PaperPoint(double delta, std::optional<double> epsilon = {},
                                  std::optional<double> exponent = {}) {
  return {{kRho, kPaperRho}, {kDelta, delta}, {kEpsilon, epsilon}, {kExponent, exponent}};
}

// At the paper's rho; the reservoirs of `gas-conduction` are at 1.5 and 0.5.
inline PointParameters PaperGas(const ExperimentKind* experiment, double delta,
                                const GasShape& shape = {.columns = 2}) {
  PointParameters point = {{kRho, kPaperRho}, {kDelta, delta}, {kCells, CodeOf(shape)}};
  if (experiment == &kGasEquilibrium || experiment == &kGasLyapunov) point.Set(kTemperature, 2);
  if (experiment == &kGasConduction) {
    point.Set(kHot, 1.5);
    point.Set(kCold, 0.5);
  }
  return point;
}

// The models that sample gas-equilibrium and gas-conduction.
inline constexpr Model kModelsThatSampleGases[] = {Model::kMarkov, Model::kBilliard,
                                                   Model::kBilliardReference};

inline bool IsOfAGas(const ExperimentKind* experiment) {
  const auto is_cells = [](const ParameterUse& use) { return use.parameter == &kCells; };
  return std::ranges::any_of(experiment->parameters, is_cells);
}

inline EnsembleSpec SpecOf(const ExperimentKind* experiment, const PointParameters& point,
                           const Target& target = {}, Model model = Model::kAuto,
                           uint64_t seed = 0) {
  EnsembleSpec spec = {.experiment = experiment, .target = target, .seed = seed, .model = model};
  for (const Parameter* parameter : kParameters) {
    if (const auto& value = point.Find(*parameter)) spec.grid[*parameter] = {*value};
  }
  return spec;
}

}  // namespace ballpiston
