#include "tools/method_comparison/point_runs.h"

#include <bit>

#include "core/ensemble/point_fold.h"
#include "server/processor_time.h"

namespace ballpiston::method_comparison {

SampleRange TruthOf(uint64_t samples) {
  // The runs are [4^k, 2 4^k). The gap that starts at 2 4^k has the same length.
  const bool is_start_of_run = std::countr_zero(samples) % 2 == 0;
  return {is_start_of_run ? 2 * samples : samples, samples};
}

PointEstimate RunSamples(const PointExperiment& experiment, const SampleRange& samples) {
  const double begin = server::ThreadSeconds();
  const BlockResult merged =
      *RunBlock(experiment, {.first = samples.first, .samples = samples.count});
  const Estimate estimate = experiment.FirstEstimate(merged);
  return {.value = estimate.value,
          .error = estimate.standard_error.value_or(0),
          .samples = merged.samples,
          .seconds = server::ThreadSeconds() - begin};
}

}  // namespace ballpiston::method_comparison
