// Returns to the collision surface at fixed energies, with starts from the invariant law, by any
// method: their times, their ingoing angles and their cost.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ensemble/random_stream.h"
#include "core/experiment/returns.h"
#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

// Exact probabilities of the ingoing angles, in the cells of `first-hit`: kIngoingBins bins of
// alpha for each allowed sign sigma of the piston's velocity, sigma = -1 first.
std::vector<double> IngoingProbabilities(double epsilon);

// Statistics of the orbits that were not lost.
struct ReturnStatistics {
  Moments times = {};
  std::vector<Histogram> ingoing;  // of the angles, by sigma
  uint64_t wall_hits = 0;          // of the ball
  double seconds = 0;              // of processor time

  // In the order of IngoingProbabilities.
  std::vector<uint64_t> IngoingCounts() const;
};

// Runs the samples 0 ... samples - 1 of the stream. Requires a method with orbits, as does
// PredictedSeconds.
ReturnStatistics RunReturns(const Method& method, const PairGeometry& geometry, double epsilon,
                            const RandomStream& random, uint64_t samples);

// Predicted cost of `samples` returns on a processor of about 3 GHz, within a factor of three.
double PredictedSeconds(const Method& method, const PairGeometry& geometry, double epsilon,
                        uint64_t samples);

}  // namespace ballpiston::method_comparison
