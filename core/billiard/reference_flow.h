// The billiard flow in double precision, computed event by event. Every faster engine is compared
// with it, and traces use it. event_flow.h describes the method and its properties.
#ifndef BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_
#define BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

extern template class EventFlow<double>;

using ReferenceFlow = EventFlow<double>;

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_
