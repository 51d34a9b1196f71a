// The server's numbers at this moment, for the metrics and for GetServerStatus.
#pragma once

#include "ballpiston/v1/server.pb.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

// Of all principals, and without what only GetServerStatus adds: stored jobs, limits, rates and the
// caller. Does not wait for the disk and holds no lock that a worker needs.
v1::ServerStatus StatusOf(const ServiceContext& service);

}  // namespace ballpiston::server
