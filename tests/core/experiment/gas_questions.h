// Functions that the tests of the gas's experiments share.
#pragma once

#include "core/ensemble/point_experiment.h"
#include "tests/core/one_point_spec.h"

namespace ballpiston {

// The summary of measured replicas by the spec's experiment.
inline PointSummary Summarized(const EnsembleSpec& spec, const BlockResult& merged) {
  return PointExperiment::Create(spec, 0)->Summarize(merged);
}

}  // namespace ballpiston
