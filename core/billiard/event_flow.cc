#include "core/billiard/event_flow-inl.h"

namespace ballpiston {

template class EventFlow<double>;

}  // namespace ballpiston
