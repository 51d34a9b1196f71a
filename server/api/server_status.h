// The server's numbers at this moment, for the metrics and for GetServerStatus.
#pragma once

#include "ballpiston/v1/server.pb.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

// The totals and the numbers of every principal. Without the fields that only GetServerStatus adds:
// rates, limits and the caller. Reads the store, but does not wait for writes. Holds no lock that a
// worker needs.
v1::ServerStatus StatusOf(const ServiceContext& service);

}  // namespace ballpiston::server
