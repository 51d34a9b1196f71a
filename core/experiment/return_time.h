// The estimates from a sample of return times, with errors if the sample is large enough.
#ifndef BALLPISTON_CORE_EXPERIMENT_RETURN_TIME_H_
#define BALLPISTON_CORE_EXPERIMENT_RETURN_TIME_H_

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
  // Empty if no error can be estimated; the scatter of the sample has no meaning then.
  std::optional<Estimate> CoefficientOfVariation(const Moments& times) const;

 private:
  double EventsIn(const Moments& times) const;

  double exact_mean_;
  double long_returns_per_sample_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_RETURN_TIME_H_
