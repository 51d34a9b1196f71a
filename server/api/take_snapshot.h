// The server's counts at this moment, for the metrics and for GetServerStatus.
#ifndef BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_
#define BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_

#include "server/api/service_context.h"
#include "server/observability/server_snapshot.h"

namespace ballpiston::server {

// Does not wait for the disk and holds no lock that a worker needs. Reads every active job, which
// takes some 50 ns each.
ServerSnapshot TakeSnapshot(const ServiceContext& service);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_
