// The limit of a sequence that approaches it with a power law.
//
// v(n) = limit + c_0 n^-p + c_1 n^-(p+1) + ... , with as many terms as the values determine. The
// solutions of the jump process are not smooth where an energy is 0, so polynomials converge with a
// power of their degree. Measured powers: d + 2 for the conductivity, where d is the least number
// of a site's velocity components; 6 for the gap of balls and pistons. The error of clusters of n
// sites falls as n^-6.
#pragma once

#include <absl/types/span.h>

#include "core/conductivity/conductivity.h"

namespace ballpiston {

// `at` is ascending and positive. `at` and `values` have the same size, two or more.
BoundedValue TailLimit(absl::Span<const double> at, absl::Span<const double> values, double power);

}  // namespace ballpiston
