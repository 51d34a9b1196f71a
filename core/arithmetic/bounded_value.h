// A computed value, without samples, and a bound of its error.
#pragma once

namespace ballpiston {

struct BoundedValue {
  double value;
  double error;
};

}  // namespace ballpiston
