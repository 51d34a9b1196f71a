// The billiard flow in other precisions than double. It shows the effect of rounding on an orbit,
// and gives orbits beyond the precision of a double. event_flow.h describes the flow.
//
//   float         24 bits
//   long double   64 bits on x86, in hardware
//   Quad         113 bits (quad_precision.h)
//   TwinNumber   256 bits, about 150 ns per operation; for twins of orbits in other precisions
//
// Include it only to compare precisions: it includes Boost's numbers.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "core/billiard/event_flow.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {

using TwinNumber = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<256, boost::multiprecision::digit_base_2>,
    boost::multiprecision::et_off>;

extern template class EventFlow<float>;
extern template class EventFlow<long double>;
extern template class EventFlow<Quad>;
extern template class EventFlow<TwinNumber>;

}  // namespace ballpiston
