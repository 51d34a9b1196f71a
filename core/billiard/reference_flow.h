// The billiard flow in double precision, every event resolved, one at a time: the yardstick for
// every faster engine, and the source of traces. What it does and promises: event_flow.h.
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
