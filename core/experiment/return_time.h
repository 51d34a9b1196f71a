// The estimates from a sample of return times, with errors if the sample is large enough.
#pragma once

#include <optional>
#include <string>

#include "core/ensemble/point_summary.h"
#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"

namespace ballpiston {

class ReturnTime {
 public:
  ReturnTime(const PairGeometry& geometry, double epsilon);

  // The mean under the invariant law, exact at every delta.
  double exact_mean() const { return exact_mean_; }

  Estimate Mean(std::string name, const Moments& times) const;
  // Empty if the mean has no error; the scatter of the sample has no meaning then. Its own error
  // needs more samples.
  std::optional<Estimate> CoefficientOfVariation(const Moments& times) const;
  // Why the mean of a sample that is not small has no error.
  std::optional<std::string> Remark(const Moments& times) const;

 private:
  double EventsIn(const Moments& times) const;

  double epsilon_;
  double exact_mean_;
  double long_returns_per_sample_;
};

}  // namespace ballpiston
