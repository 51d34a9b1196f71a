// Runs of samples of an experiment's point.
//
// A run of n samples has the samples n ... 2 n - 1 of the point's stream. Therefore runs of 64,
// 256, 1024, ... samples have no sample in common. The samples of the truth are in the gaps between
// the runs. Property, with a test of its name: 1. RunsHaveNoSampleInCommon, truth included.
#pragma once

#include <bit>
#include <cstdint>

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
inline SampleRange TruthOf(uint64_t samples) {
  // The runs are [4^k, 2 4^k). The gap that starts at 2 4^k has the same length.
  const bool is_start_of_run = std::countr_zero(samples) % 2 == 0;
  return {is_start_of_run ? 2 * samples : samples, samples};
}

}  // namespace ballpiston::method_comparison
