// The results of a point's merged blocks: estimates with errors, and exact values beside them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ensemble/block_result.h"
#include "core/statistics/histogram.h"
#include "core/statistics/kl_divergence.h"

namespace ballpiston {

struct Estimate {
  std::string name = {};
  double value = 0;                           // NaN if nothing was measured
  std::optional<double> standard_error = {};  // empty with too few samples
  // The error is as uncertain as that of the mean of this many independent normal numbers:
  // value +- t standard_error covers the true value with Student's probability for batches - 1
  // degrees of freedom. 0 if the error does not come from a scatter: then t is that of a normal
  // law.
  uint64_t batches = 0;
  std::optional<double> exact = {};  // the closed form, if one exists
  std::optional<double> limit = {};  // the value in the limit delta -> 0, if known
  // For a distance between laws, which is never below 0: its mean if the two laws were equal.
  std::optional<double> noise_floor = {};

  // (value - exact)/standard_error; empty unless both exist and the error is not 0.
  std::optional<double> ZScore() const {
    if (!exact || !standard_error || *standard_error == 0) return std::nullopt;
    return (value - *exact) / *standard_error;
  }
};

// Counts of the ingoing angle for one sign of the piston's velocity, of an energy at a time, or of
// a speed in a gas. A model without samples has no counts.
struct NamedHistogram {
  std::string name;
  int sigma = 0;  // of an ingoing angle +1 or -1, else 0
  Histogram histogram;
  std::optional<double> time = {};  // in cells over unit speed
};

// The variable of a curve. A time is in cells over unit speed. A position is in cells from the left
// reservoir of a gas.
enum class CurveAxis { kTime, kPosition };

struct CurvePoint {
  double at = 0;  // along the curve's axis
  double value = 0;
  std::optional<double> standard_error = {};
  uint64_t batches = 0;              // as in Estimate
  std::optional<double> limit = {};  // the value in the limit delta -> 0
};

struct Curve {
  std::string name;
  std::vector<CurvePoint> points = {};
  CurveAxis axis = CurveAxis::kTime;
};

struct PointSummary {
  uint64_t samples = 0;
  std::vector<Estimate> estimates = {};  // a tolerance refers to the first estimate
  std::optional<KlDivergence> kl_divergence = {};
  std::vector<NamedHistogram> histograms = {};
  std::vector<Curve> curves = {};
  Health health = {};
  // Sentences for the user about the result, for instance that a run was too short.
  std::vector<std::string> remarks = {};
};

}  // namespace ballpiston
