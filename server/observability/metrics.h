// The server's numbers as Prometheus has them: base units, totals that only grow, no job's id and
// no principal in a label. Pure functions.
//
//   grpc_server_*   calls: the names and labels that other gRPC servers use
//   ballpiston_*    everything else
#ifndef BALLPISTON_SERVER_OBSERVABILITY_METRICS_H_
#define BALLPISTON_SERVER_OBSERVABILITY_METRICS_H_

#include <vector>

#include "prometheus/metric_family.h"
#include "server/observability/call_statistics.h"
#include "server/observability/server_snapshot.h"

namespace ballpiston::server {

std::vector<prometheus::MetricFamily> CallMetrics(const std::vector<MethodCounts::Totals>& calls);
std::vector<prometheus::MetricFamily> ServerMetrics(const ServerSnapshot& server);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_METRICS_H_
