// Cumulants of a law, from the moments of a sample; and errors by the jackknife.
//
// With m_k the central moments: c_2 = m_2, c_3 = m_3, c_4 = m_4 - 3 m_2^2.
// Properties, each with the test that bears its name:
//   1. CumulantsOfKnownLaws.  2. TheJackknifeOfAMeanIsItsStandardError.
#pragma once

#include <cstddef>
#include <functional>

#include "core/statistics/moments.h"

namespace ballpiston {

// order: 2, 3 or 4. Requires a sample.
double Cumulant(const Moments& sample, int order);

struct Jackknifed {
  double value = 0;
  double error = 0;
};

// `without(i)` is the quantity from all groups but group i; without(groups) is that from all
// groups. Groups must be independent and of the same size; groups >= 2. A bias in proportion to
// 1/groups is removed.
Jackknifed Jackknife(size_t groups, const std::function<double(size_t)>& without);

}  // namespace ballpiston
