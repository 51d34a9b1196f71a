// The server's numbers as they are now, for metrics and for its status.
#ifndef BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_
#define BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_

#include "server/api/service_context.h"
#include "server/observability/server_snapshot.h"

namespace ballpiston::server {

// Waits for no disk and holds no lock that a worker needs; takes a look at every active job, some
// 50 ns each.
ServerSnapshot TakeSnapshot(const ServiceContext& service);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_TAKE_SNAPSHOT_H_
