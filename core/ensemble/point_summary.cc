#include "core/ensemble/point_summary.h"

namespace ballpiston {

std::optional<double> Estimate::ZScore() const {
  if (!exact || !standard_error || *standard_error == 0) return std::nullopt;
  return (value - *exact) / *standard_error;
}

}  // namespace ballpiston
