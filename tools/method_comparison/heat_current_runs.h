// Measures the heat current of one cell between two reservoirs, and its cost, by the methods that
// can run a gas. A sample is a replica of the gas of experiment/gas_conduction.cc. It starts near
// local equilibrium, relaxes for four relaxation times, and is measured for twelve.
//
// All methods run the same replicas for the same times. A replica of the fixed time steps that
// loses a ball is not counted. The jump process has the current of the limit, not of the billiard.
// Property, with a test of its name: 1. AllMethodsAgree, within their errors and biases.
#pragma once

#include <cstdint>

#include "core/gas/gas_shape.h"
#include "tools/method_comparison/method.h"
#include "tools/method_comparison/point_runs.h"

namespace ballpiston::method_comparison {

// A ball between two pistons. At the same work the error grows as the number of cells. With more
// cells the error would hide the bias of the limit.
inline constexpr GasShape kComparedChain = {.columns = 1};
inline constexpr double kComparedHot = 1.5;
inline constexpr double kComparedCold = 0.5;

class HeatCurrentRuns {
 public:
  // `delta` must be valid for a gas.
  HeatCurrentRuns(double rho, double delta, uint64_t seed)
      : rho_(rho), delta_(delta), seed_(seed) {}

  double delta() const { return delta_; }

  // For kFixedStep, kReference, kLanes and kMarkov, on a processor of about 3 GHz, within a factor
  // of three.
  double PredictedSecondsPerReplica(const MethodVariant& variant) const;

  // Runs one of these methods.
  PointEstimate Run(const MethodVariant& variant, const SampleRange& samples) const;

 private:
  double rho_;
  double delta_;
  uint64_t seed_;
};

}  // namespace ballpiston::method_comparison
