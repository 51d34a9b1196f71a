// Runs a whole point, as the server does.
#ifndef BALLPISTON_TESTS_STATISTICAL_RUN_POINT_H_
#define BALLPISTON_TESTS_STATISTICAL_RUN_POINT_H_

#include "core/experiment/point_experiment.h"

namespace ballpiston {

inline PointSummary RunPoint(const EnsembleSpec& spec, size_t index = 0) {
  const auto point = PointExperiment::Create(spec, index);
  BlockResult merged;
  uint64_t block = 0;
  do {
    merged.Merge(*point->RunBlock(block, {}));
  } while (!point->TargetReached(++block, merged));
  return point->Summarize(merged);
}

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_STATISTICAL_RUN_POINT_H_
