#include "core/ensemble/point_memory.h"

#include <algorithm>

#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {
namespace {

// Of a point without its samples.
constexpr double kOfAnAnswer = 1e6;

}  // namespace

double MemoryOfAThread(const EnsembleSpec& spec, const PointParameters& point) {
  return spec.experiment->memory(Sampled(spec.model), point);
}

double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads) {
  if (NeedsNoSamples(spec)) return kOfAnAnswer;
  const double used =
      std::min(static_cast<double>(threads), static_cast<double>(SamplesAskedFor(spec, point)));
  constexpr auto kWaitingResults = static_cast<double>(ChunkFold::kWindow);
  return kOfAnAnswer + kWaitingResults * spec.experiment->memory_of_a_result +
         used * MemoryOfAThread(spec, point);
}

}  // namespace ballpiston
