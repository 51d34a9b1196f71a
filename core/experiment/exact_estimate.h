// An estimate that is a closed form.
#ifndef BALLPISTON_CORE_EXPERIMENT_EXACT_ESTIMATE_H_
#define BALLPISTON_CORE_EXPERIMENT_EXACT_ESTIMATE_H_

#include <string>
#include <utility>

#include "core/ensemble/point_summary.h"

namespace ballpiston {

// Its standard error is the bound of the formula's rounding.
inline Estimate ExactEstimate(std::string name, double value, double relative_error) {
  return {.name = std::move(name),
          .value = value,
          .standard_error = relative_error * value,
          .exact = value};
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_EXACT_ESTIMATE_H_
