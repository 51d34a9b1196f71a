#include "core/ensemble/point_memory.h"

#include <algorithm>

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston {
namespace {

// Of a point without samples, and of the merged and the waiting results of a point with samples.
// 1024 results of first-hit, the largest, take 18 MB (ChunkFold::kWindow).
constexpr double kOfAnAnswer = 1e6;
constexpr double kOfResults = 20e6;

}  // namespace

double MemoryOfAThread(const EnsembleSpec& spec, const PointParameters& point) {
  return spec.experiment->memory(Sampled(spec.model), point);
}

double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads) {
  if (NeedsNoSamples(spec)) return kOfAnAnswer;
  const double used =
      std::min(static_cast<double>(threads), static_cast<double>(SamplesAskedFor(spec, point)));
  return kOfResults + used * MemoryOfAThread(spec, point);
}

}  // namespace ballpiston
