// The billiard flow in double precision, computed event by event. Every faster engine is compared
// with it, and traces use it. event_flow.h describes the method and its properties.
#pragma once

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

extern template class EventFlow<double>;

using ReferenceFlow = EventFlow<double>;

}  // namespace ballpiston
