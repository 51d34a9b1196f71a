// Collisions as CSV: a column for each field of the message, a row for each collision. Numbers read
// back as the same double.
#pragma once

#include <ostream>

#include "ballpiston/v1/trace.pb.h"

namespace ballpiston::client {

void PrintCollisionHeader(std::ostream& out);
void PrintCollisions(const v1::SampleCollisionsResponse& message, std::ostream& out);

}  // namespace ballpiston::client
