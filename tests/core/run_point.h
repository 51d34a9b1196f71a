// Runs a whole point, as the server does. Also has the headers of points and of their questions.
#pragma once

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "tests/core/one_point_spec.h"
#include "tests/support/preamble.h"

namespace ballpiston {

inline PointSummary RunPoint(const EnsembleSpec& spec) {
  const auto point = PointExperiment::Create(spec, 0);
  return point->Summarize(FoldPoint(*point));
}

// The summary of measured samples by the spec's experiment.
inline PointSummary Summarized(const EnsembleSpec& spec, const BlockResult& merged) {
  return PointExperiment::Create(spec, 0)->Summarize(merged);
}

// The relative error that the plan states for this number of samples, over the measured error of
// the first estimate.
inline double StatedOverMeasured(const EnsembleSpec& spec) {
  const PointSummary summary = RunPoint(spec);
  const Estimate& first = summary.estimates.front();
  const double stated =
      ScatterOf(spec, PointAt(spec, 0)).error / std::sqrt(static_cast<double>(summary.samples));
  return stated * std::fabs(first.value) / first.standard_error.value();
}

inline std::vector<std::string> NamesOf(const PointSummary& summary) {
  std::vector<std::string> names;
  for (const Estimate& estimate : summary.estimates) names.push_back(estimate.name);
  return names;
}

inline const Estimate& Named(std::string_view name, const std::vector<Estimate>& estimates) {
  for (const Estimate& estimate : estimates) {
    if (estimate.name == name) return estimate;
  }
  ADD_FAILURE() << "no " << name;
  return estimates.front();
}

}  // namespace ballpiston
