#include "tools/flows/precise_flow.h"

namespace ballpiston {

template class EventFlow<float>;
template class EventFlow<long double>;
template class EventFlow<Quad>;
template class EventFlow<TwinNumber>;

}  // namespace ballpiston
