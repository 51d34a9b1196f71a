// An estimate that is a closed form.
#pragma once

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
