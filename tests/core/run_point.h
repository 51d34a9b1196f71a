// Runs a whole point, as the server does.
#ifndef BALLPISTON_TESTS_CORE_RUN_POINT_H_
#define BALLPISTON_TESTS_CORE_RUN_POINT_H_

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

#include "core/experiment/point_experiment.h"

namespace ballpiston {

inline BlockResult RunBlocks(const PointExperiment& point) {
  BlockResult merged;
  uint64_t block = 0;
  do {
    merged.Merge(*point.RunBlock(block, {}));
  } while (!point.TargetReached(++block, merged));
  return merged;
}

inline PointSummary RunPoint(const EnsembleSpec& spec, size_t index = 0) {
  const auto point = PointExperiment::Create(spec, index);
  return point->Summarize(RunBlocks(*point));
}

inline const Estimate& Named(std::string_view name, const std::vector<Estimate>& estimates) {
  for (const Estimate& estimate : estimates) {
    if (estimate.name == name) return estimate;
  }
  ADD_FAILURE() << "no " << name;
  return estimates.front();
}

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_RUN_POINT_H_
