// Runs a whole point, as the server does. A question as text stands for its first point.
#pragma once

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "tests/core/asked.h"
#include "tests/support/preamble.h"

namespace ballpiston {

inline std::unique_ptr<const PointExperiment> PointOf(const std::string& question) {
  return PointExperiment::Create(Asked(question), 0);
}

inline PointSummary RunPoint(const EnsembleSpec& spec) {
  const auto point = PointExperiment::Create(spec, 0);
  return point->Summarize(FoldPoint(*point));
}

inline PointSummary RunPoint(const std::string& question) { return RunPoint(Asked(question)); }

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

// Estimates and curves are those of `low` times these factors, to rounding, and so are their errors
// and exact values; the places of the curves are those of `low` times `place`.
inline void ExpectScaled(const PointSummary& low, const PointSummary& high,
                         const std::vector<double>& estimates, const std::vector<double>& curves,
                         double place) {
  const auto expect = [](const std::optional<double>& of_low, const std::optional<double>& of_high,
                         double factor) {
    ASSERT_EQ(of_low.has_value(), of_high.has_value());
    if (of_low) {
      EXPECT_DOUBLE_EQ(*of_high, factor * *of_low);
    }
  };
  ASSERT_EQ(high.estimates.size(), estimates.size());
  for (size_t i = 0; i < estimates.size(); ++i) {
    const Estimate &a = low.estimates[i], &b = high.estimates[i];
    SCOPED_TRACE(a.name);
    expect(a.value, b.value, estimates[i]);
    expect(a.standard_error, b.standard_error, estimates[i]);
    expect(a.exact, b.exact, estimates[i]);
  }
  for (size_t i = 0; i < curves.size(); ++i) {
    ASSERT_EQ(high.curves[i].points.size(), low.curves[i].points.size());
    for (size_t k = 0; k < low.curves[i].points.size(); ++k) {
      const CurvePoint &a = low.curves[i].points[k], &b = high.curves[i].points[k];
      expect(a.at, b.at, place);
      expect(a.value, b.value, curves[i]);
      expect(a.standard_error, b.standard_error, curves[i]);
    }
  }
}

}  // namespace ballpiston
