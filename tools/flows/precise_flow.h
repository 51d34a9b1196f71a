// The billiard flow in other precisions than double. It shows the effect of rounding on an orbit,
// and gives orbits beyond the precision of a double. event_flow.h describes the flow.
//
//   float         24 bits
//   long double   64 bits on x86, in hardware
//   Quadruple    113 bits, about 20 ns per operation
//   TwinNumber   256 bits, about 150 ns per operation; for twins of orbits in other precisions
//
// Include it only to compare precisions: it includes Boost's numbers.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#include <boost/multiprecision/float128.hpp>
#endif

#include "core/billiard/event_flow.h"

namespace ballpiston {

// GCC's own 113 bits on x86. As measured, its products are four times and its roots nine times as
// fast as Boost's.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
using Quadruple = boost::multiprecision::float128;
#else
using Quadruple = boost::multiprecision::cpp_bin_float_quad;
#endif

using TwinNumber = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<256, boost::multiprecision::digit_base_2>,
    boost::multiprecision::et_off>;

extern template class EventFlow<float>;
extern template class EventFlow<long double>;
extern template class EventFlow<Quadruple>;
extern template class EventFlow<TwinNumber>;

}  // namespace ballpiston
