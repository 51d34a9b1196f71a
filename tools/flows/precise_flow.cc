#include "tools/flows/precise_flow.h"

#include "core/billiard/event_flow-inl.h"

namespace ballpiston {

template class EventFlow<float>;
template class EventFlow<long double>;
template class EventFlow<Quadruple>;
template class EventFlow<TwinNumber>;

}  // namespace ballpiston
