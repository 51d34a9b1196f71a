// The server's counts at this moment, for the metrics and for GetServerStatus.
#pragma once

#include "server/api/service_context.h"
#include "server/observability/server_snapshot.h"

namespace ballpiston::server {

// Does not wait for the disk and holds no lock that a worker needs. Reads every active job, which
// takes some 50 ns each.
ServerSnapshot TakeSnapshot(const ServiceContext& service);

}  // namespace ballpiston::server
