// The billiard flow in other precisions than double: to see what rounding does to an orbit, and to
// know the orbit beyond the reach of a double. event_flow.h says what it does and promises.
//
//   float         24 bits
//   long double   64 bits on x86, the processor's own
//   Quadruple    113 bits, some 20 ns an operation
//   TwinNumber   256 bits, some 150 ns an operation; a twin for orbits in any of the others
//
// Only for those who compare precisions: it includes Boost's numbers.
#ifndef BALLPISTON_TOOLS_FLOWS_PRECISE_FLOW_H_
#define BALLPISTON_TOOLS_FLOWS_PRECISE_FLOW_H_

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#include <boost/multiprecision/float128.hpp>
#endif

#include "core/billiard/event_flow.h"

namespace ballpiston {

// GCC's own 113 bits on x86: measured, products four and roots nine times as fast as Boost's.
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

#endif  // BALLPISTON_TOOLS_FLOWS_PRECISE_FLOW_H_
