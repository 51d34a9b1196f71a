// Runs samples of a point of an experiment as the service would, and measures their cost.
//
// A run of n samples has the samples n ... 2 n - 1 of the point's stream. Therefore runs of 64,
// 256, 1024, ... samples have no sample in common. The samples of the truth are in the gaps between
// the runs. A run is one block; it is not divided into chunks and blocks like a job. Property, with
// a test of its name: 1. RunsHaveNoSampleInCommon, truth included.
#pragma once

#include <cstdint>

#include "core/ensemble/block_result.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::method_comparison {

// The first estimate of a point.
struct PointEstimate {
  double value = 0;
  double error = 0;      // one standard error; 0 if there are too few samples
  uint64_t samples = 0;  // 0 if the value was computed without samples
  double seconds = 0;    // of processor time
};

// Samples first ... first + count - 1 of a point's stream.
struct SampleRange {
  uint64_t first;
  uint64_t count;  // a power of two, like first

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// The samples of a run; `samples` is 64, 256, 1024, ...
inline SampleRange RunOf(uint64_t samples) { return {samples, samples}; }
// The samples of the truth; `samples` is any power of two.
SampleRange TruthOf(uint64_t samples);

PointEstimate RunSamples(const PointExperiment& experiment, const SampleRange& samples);

}  // namespace ballpiston::method_comparison
